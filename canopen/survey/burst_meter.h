#pragma once

#include <cstdint>
#include <optional>

#include "canopen/survey/day_extremes.h"
#include "canopen/survey/moment.h"

namespace canopen {

/// Frames with no pause between them that another one would have fitted in.
struct Burst {
  std::uint32_t frames = 0;  ///< Of the one with the most frames.
  Duration time{};           ///< Of the longest one, from its first frame to its last.
  friend bool operator==(const Burst&, const Burst&) = default;
};

/// The longest bursts of a day. What an adapter collects and hands over at once has one time, and counts as a burst.
class BurstMeter {
 public:
  /// Zero: not known, and there are no bursts.
  void set_bitrate(std::uint32_t bitrate) noexcept;
  void hear(const Moment& moment) noexcept;
  /// Now and then: one that is long over belongs to this hour, and no longer goes on.
  void settle(TimePoint now, std::uint32_t hour) noexcept;
  /// The one that goes on is among them. Nothing without a bit rate, or where no frame came.
  [[nodiscard]] std::optional<Burst> of_day(std::uint32_t hour) const noexcept;

 private:
  void end(std::uint32_t hour) noexcept;

  Duration longest_gap_{};
  TimePoint first_{};
  TimePoint last_{};
  std::uint32_t count_ = 0;  ///< Of the one that goes on.
  std::uint32_t unbroken_ = 0;
  DayExtremes frames_;
  DayExtremes times_;
};

}  // namespace canopen
