#pragma once

#include <string_view>

#include "bridges/alarms/alarm.h"
#include "canopen/bus/bus_state.h"
#include "canopen/node/node_events.h"
#include "config/model.h"

namespace alarms {

// The closed list of Alarm::reason, but for `control` (control_alarm.h), `data` and more of a bus (bus_findings.h);
// docs/ALARMS.md says what each means.

/// `never-appeared` or `lost`: of a node whose error control ran out.
[[nodiscard]] std::string_view heartbeat_reason(const canopen::NodeStatus& status) noexcept;
/// A word for each letter of CiA 302-2, `left-operational` and `found-stopped` beside letter J, and `undecided` where
/// there is a text and no letter; empty: no alarm.
[[nodiscard]] std::string_view boot_reason(const canopen::NodeStatus& status) noexcept;
/// `warning`, `passive`, `bus-off`, `down`; empty: no alarm.
[[nodiscard]] std::string_view bus_reason(canopen::BusCondition condition) noexcept;

/// Of an alarm without codes; of `emcy` each error has its own.
[[nodiscard]] config::Severity severity_of(AlarmKind kind) noexcept;
[[nodiscard]] config::Severity severity_of(canopen::BusCondition condition) noexcept;

}  // namespace alarms
