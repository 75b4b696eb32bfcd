#include <algorithm>
#include <utility>

#include "bridges/recorder/record.h"

namespace recorder {

void RecordedAlarm::change(alarms::Alarm now) {
  const bool is_fault = now.active && now.severity == config::Severity::fault;
  if (now.first) {
    alarm.first = true;
  } else if (at_end.first && is_fault) {
    alarm.first = false;
  }
  for (const alarms::AlarmError& error : now.errors) {
    const auto is_same = [&error](const alarms::AlarmError& other) {
      return other.code == error.code && other.vendor == error.vendor;
    };
    if (alarm.errors.size() < kMostErrors && std::ranges::none_of(alarm.errors, is_same)) {
      alarm.errors.push_back(error);
    }
  }
  at_end = std::move(now);
}

}  // namespace recorder
