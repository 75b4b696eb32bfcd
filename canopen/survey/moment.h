#pragma once

#include <algorithm>
#include <cstdint>

#include "canopen/clock.h"

namespace canopen {

/// When a frame came, for whoever keeps figures of frames.
struct Moment {
  TimePoint at{};
  std::uint32_t hour = 0;  ///< See hour_of(); a second late at most.
  /// Another number: frames may be missing in between, or the bus was away. What lasted across is not told.
  std::uint32_t unbroken = 0;
};

/// How a day's figures hold a duration: at most 73 minutes.
[[nodiscard]] constexpr std::uint32_t to_units(Duration duration) noexcept {
  return static_cast<std::uint32_t>(std::clamp<std::int64_t>(duration.count() >> 10U, 0, UINT32_MAX));
}
[[nodiscard]] constexpr Duration from_units(std::uint32_t units) noexcept {
  return Duration(std::int64_t{units} << 10U);
}

}  // namespace canopen
