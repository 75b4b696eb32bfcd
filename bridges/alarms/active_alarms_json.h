#pragma once

#include <span>
#include <string>
#include <string_view>

#include "bridges/alarms/alarm.h"

namespace alarms {

/// An active alarm as the list of them names it. What it points to outlives it.
struct ListedAlarm {
  std::string_view drive{};  ///< Empty: it is of a bus.
  std::string_view bus{};    ///< Of a bus.
  AlarmKind kind{};          ///< Of a drive; a bus has one alarm, of the kind `bus`.
  const Alarm* alarm = nullptr;
};

/// One of them as a JSON object.
void append_listed(std::string& out, const ListedAlarm& listed);
/// A JSON array of them, in this order; `[]` where there is none.
[[nodiscard]] std::string active_alarms_json(std::span<const ListedAlarm> active);

}  // namespace alarms
