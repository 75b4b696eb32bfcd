#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

#include "canopen/clock.h"

namespace canopen {

/// How long a node takes to confirm a write, by the newest confirmed ones. A plain value.
class WriteTimes {
 public:
  static constexpr std::size_t kKept = 16;
  static constexpr Duration kUsual = std::chrono::milliseconds(50);  ///< Before anything is known.

  void note(Duration took) noexcept {
    times_[noted_ % kKept] = took;
    ++noted_;
  }
  [[nodiscard]] Duration longest() const noexcept {
    return noted_ == 0 ? kUsual : *std::max_element(times_.begin(), times_.end());
  }

 private:
  std::array<Duration, kKept> times_{};
  std::size_t noted_ = 0;
};

}  // namespace canopen
