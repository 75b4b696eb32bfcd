#pragma once

#include <boost/json/value.hpp>
#include <string>

#include "bridges/alarms/alarm.h"

namespace alarms {

/// An alarm that was read, or what is wrong.
struct ReadAlarm {
  Alarm alarm;        ///< Known; of no meaning where something is wrong.
  std::string wrong;  ///< For people: the member, and what it should be. Empty: nothing.
};

/// Reads back what alarm_json() wrote: every member has to be there and to be such a value. Members that it does not
/// know are passed over: a later version may have written them.
[[nodiscard]] ReadAlarm read_alarm(const boost::json::value& value);

}  // namespace alarms
