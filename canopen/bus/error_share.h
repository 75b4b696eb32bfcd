#pragma once

#include <bitset>
#include <cstddef>
#include <cstdint>

namespace canopen {

/// How many of the newest frames of a bus were error frames.
class ErrorShare {
 public:
  static constexpr std::size_t kWindow = 10'000;

  void add(bool error) noexcept {
    count_ = static_cast<std::uint16_t>(count_ + (error ? 1 : 0) - (errors_[next_] ? 1 : 0));
    errors_[next_] = error;
    next_ = (next_ + 1) % kWindow;
  }
  /// 0..kWindow.
  [[nodiscard]] std::uint16_t count() const noexcept { return count_; }

 private:
  std::bitset<kWindow> errors_;
  std::size_t next_ = 0;
  std::uint16_t count_ = 0;
};

}  // namespace canopen
