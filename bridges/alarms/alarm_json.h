#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "bridges/alarms/alarm.h"

namespace alarms {

/// An alarm as its topic shows it.
[[nodiscard]] std::string alarm_json(const Alarm& alarm);

/// Reads back what alarm_json() wrote. Nothing on any other text: a retained message of somebody else is no alarm.
/// An error of the list has neither vendor bytes nor severity there: it takes those of the alarm where its code and
/// text are the alarm's; else no vendor bytes, and the alarm's severity.
[[nodiscard]] std::optional<Alarm> parse_alarm(std::string_view json);

}  // namespace alarms
