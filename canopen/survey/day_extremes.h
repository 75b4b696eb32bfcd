#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>

#include "canopen/clock.h"

namespace canopen {

struct Extremes {
  std::uint32_t least = 0;
  std::uint32_t most = 0;
  friend bool operator==(const Extremes&, const Extremes&) = default;
};

/// The number of the hour of the monotonic clock.
[[nodiscard]] constexpr std::uint32_t hour_of(TimePoint at) noexcept {
  return static_cast<std::uint32_t>(std::chrono::floor<std::chrono::hours>(at.time_since_epoch()).count());
}

/// The least and the most of a figure in this hour and the 24 before: of 24 to 25 hours. A plain value of constant
/// size.
class DayExtremes {
 public:
  void add(std::uint32_t value, std::uint32_t hour) noexcept {
    Slot& slot = slots_[hour % kHours];
    if (slot.hour != hour) {
      slot = {hour, value, value};
      return;
    }
    slot.least = std::min(slot.least, value);
    slot.most = std::max(slot.most, value);
  }

  /// Nothing where nothing was added since.
  [[nodiscard]] std::optional<Extremes> of_day(std::uint32_t hour) const noexcept {
    std::optional<Extremes> all;
    for (const Slot& slot : slots_) {
      if (slot.hour != kNoHour && hour - slot.hour < kHours) {
        all = all ? Extremes{std::min(all->least, slot.least), std::max(all->most, slot.most)}
                  : Extremes{slot.least, slot.most};
      }
    }
    return all;
  }

 private:
  static constexpr std::uint32_t kHours = 25;
  static constexpr std::uint32_t kNoHour = UINT32_MAX;
  struct Slot {
    std::uint32_t hour = kNoHour;
    std::uint32_t least = 0;
    std::uint32_t most = 0;
  };
  std::array<Slot, kHours> slots_{};
};

}  // namespace canopen
