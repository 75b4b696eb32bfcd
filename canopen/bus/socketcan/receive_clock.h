#pragma once

#include "canopen/clock.h"

namespace canopen::socketcan {

/// Turns the kernel's receive stamps, which are time of day, into monotonic time. The two clocks are compared once per
/// batch. Receive times never run backwards and are never in the future; a stamp that cannot be true, because the time
/// of day was set while the frame waited, counts as the moment of reading.
class ReceiveClock {
 public:
  /// How far a stamp may lie before the one that was read last: frames of several queues or processors.
  static constexpr Duration kDisorder = std::chrono::milliseconds(50);

  /// A new socket: nothing in it was received before `now`.
  void start(TimePoint now) noexcept;
  /// What the clocks show at the reading of a batch.
  void set(TimePoint now, WallTime wall) noexcept;
  /// When the frame with this stamp was received. In the order of reception.
  [[nodiscard]] TimePoint at(WallTime stamp) noexcept;
  /// The newest receive time that came of a stamp: whatever was received before has been read.
  [[nodiscard]] TimePoint heard_until() const noexcept { return heard_until_; }

 private:
  TimePoint now_;
  WallTime wall_;
  TimePoint last_;  ///< As returned last.
  TimePoint heard_until_;
};

}  // namespace canopen::socketcan
