#pragma once

#include <chrono>
#include <optional>

#include "canopen/clock.h"

namespace alarms {

/// When the changes of one alarm are told to people and brokers: the first at once, further ones at most every
/// `kInterval`, and the last state always. What fell between two tellings shows in the alarm itself: another id, a
/// higher count. One object for each alarm and each who tells; it knows nothing of the alarm but that it changed.
class AlarmPace {
 public:
  static constexpr canopen::Duration kInterval = std::chrono::milliseconds(500);

  /// The alarm changed. Returns when that is to be told: `now`, or later.
  canopen::TimePoint note(canopen::TimePoint now);
  /// A change waits to be told, and may be told now.
  [[nodiscard]] bool due(canopen::TimePoint now) const { return next() <= now; }
  /// The alarm as it is was told; nothing waits any more.
  void told(canopen::TimePoint now);
  /// What waited turned out to be nothing to tell.
  void drop() noexcept { pending_ = false; }
  /// When the change that waits is due, which may be past; kNever: none waits.
  [[nodiscard]] canopen::TimePoint next() const;

 private:
  bool pending_ = false;
  std::optional<canopen::TimePoint> told_;  ///< Nothing: never yet.
};

}  // namespace alarms
