#pragma once

#include <algorithm>
#include <chrono>
#include <optional>

#include "canopen/clock.h"

namespace mqtt {

/// When a topic of ours on which somebody else wrote is put right: at once, but not more often than each kPause.
class PutRight {
 public:
  static constexpr canopen::Duration kPause = std::chrono::seconds(1);
  /// By then an own message has come back, where the broker sends them back (MQTT 3.1.1).
  static constexpr canopen::Duration kEcho = std::chrono::seconds(1);

  /// It says something else than ours; to be put right from `from` on. Returns when to come.
  canopen::TimePoint heard_another(canopen::TimePoint from) noexcept {
    at_ = std::min(at_, last_ ? std::max(from, *last_ + kPause) : from);
    return at_;
  }
  /// It says ours, or a new connection begins.
  void forget() noexcept { at_ = canopen::kNever; }
  /// Ours is said now, for whatever reason. True: it puts right what somebody else wrote.
  bool told(canopen::TimePoint now) noexcept {
    const bool due = is_due(now);
    if (due) {
      last_ = now;
    }
    at_ = canopen::kNever;
    return due;
  }
  [[nodiscard]] bool is_due(canopen::TimePoint now) const noexcept { return at_ <= now; }
  [[nodiscard]] canopen::TimePoint next() const noexcept { return at_; }

 private:
  canopen::TimePoint at_ = canopen::kNever;
  std::optional<canopen::TimePoint> last_;  ///< When it was put right.
};

}  // namespace mqtt
