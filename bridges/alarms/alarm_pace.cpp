#include "bridges/alarms/alarm_pace.h"

#include <algorithm>

namespace alarms {

canopen::TimePoint AlarmPace::note(canopen::TimePoint now) {
  pending_ = true;
  return std::max(next(), now);
}

void AlarmPace::told(canopen::TimePoint now) {
  pending_ = false;
  told_ = now;
}

canopen::TimePoint AlarmPace::next() const {
  if (!pending_) {
    return canopen::kNever;
  }
  return told_ ? *told_ + kInterval : canopen::TimePoint::min();
}

}  // namespace alarms
