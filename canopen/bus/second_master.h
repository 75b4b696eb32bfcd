#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>

#include "canopen/clock.h"

namespace canopen {

/// What only a master sends.
enum class MasterSign : std::uint8_t { nmt, sdo, rpdo, sync };

/// Whether somebody else acts as a master on our bus, by what was heard within the last minute. A plain value.
class SecondMaster {
 public:
  static constexpr Duration kForgotten = std::chrono::minutes(1);

  /// True where this kind of sign is new: text() is another one now.
  bool hear(MasterSign sign, TimePoint at, std::uint8_t node = 0, std::uint8_t command = 0) noexcept;
  /// True where a sign is too old by now: text() is another one.
  bool forget(TimePoint now) noexcept;
  [[nodiscard]] bool there() const noexcept;
  /// What it does, with the first frame of each kind; empty where nobody is there.
  [[nodiscard]] std::string text() const;

 private:
  struct Heard {
    bool there = false;
    std::uint8_t node = 0;     ///< That the first one was for; NMT: 0 is all.
    std::uint8_t command = 0;  ///< NMT: the command specifier.
    TimePoint last{};
  };
  [[nodiscard]] Heard& of(MasterSign sign) noexcept { return heard_[static_cast<std::size_t>(sign)]; }
  [[nodiscard]] const Heard& of(MasterSign sign) const noexcept { return heard_[static_cast<std::size_t>(sign)]; }

  std::array<Heard, 4> heard_{};
};

}  // namespace canopen
