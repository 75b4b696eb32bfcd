#pragma once

#include <string>

#include "bridges/alarms/alarm.h"

namespace alarms {

/// An alarm as its topic shows it.
[[nodiscard]] std::string alarm_json(const Alarm& alarm);

}  // namespace alarms
