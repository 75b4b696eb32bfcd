#include "bridges/alarms/register_watch.h"

#include <algorithm>

namespace alarms {
namespace {

constexpr canopen::Duration kOften = std::chrono::seconds(1);
constexpr canopen::Duration kSeldom = std::chrono::seconds(10);
constexpr canopen::Duration kOftenFor = std::chrono::minutes(1);

}  // namespace

void RegisterWatch::on_emergency(canopen::TimePoint at) noexcept {
  emergency_ = at;
  // Emergencies that chatter put it off once, not for ever.
  if (!waits_from_ || at >= *waits_from_ + 2 * kOften) {
    waits_from_ = at;
  }
}

void RegisterWatch::on_read(canopen::TimePoint at, bool answered) noexcept {
  read_ = at;
  misses_ = answered ? 0 : misses_ + 1;
  waits_from_.reset();
}

canopen::TimePoint RegisterWatch::next(std::optional<canopen::TimePoint> undecided_since) const noexcept {
  if (!undecided_since) {
    return canopen::kNever;
  }
  canopen::TimePoint next = *undecided_since;
  canopen::TimePoint begin = *undecided_since;
  if (emergency_) {
    begin = std::max(begin, *emergency_);
  }
  if (waits_from_) {
    next = std::max(next, *waits_from_ + kOften);
  }
  if (read_) {
    const bool often = !silent() && *read_ + kOften <= begin + kOftenFor;
    next = std::max(next, *read_ + (often ? kOften : kSeldom));
  }
  return next;
}

}  // namespace alarms
