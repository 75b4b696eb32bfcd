#include "canopen/bus/socketcan/receive_clock.h"

#include <algorithm>

namespace canopen::socketcan {

void ReceiveClock::start(TimePoint now) noexcept {
  last_ = now;
  heard_until_ = now;
}

void ReceiveClock::set(TimePoint now, WallTime wall) noexcept {
  now_ = now;
  wall_ = wall;
}

TimePoint ReceiveClock::at(WallTime stamp) noexcept {
  const TimePoint stamped = now_ - (wall_ - stamp);
  if (stamped > now_ || stamped < last_ - kDisorder) {
    last_ = std::max(last_, now_);
    return last_;
  }
  last_ = std::max(last_, stamped);
  heard_until_ = std::max(heard_until_, stamped);
  return last_;
}

}  // namespace canopen::socketcan
