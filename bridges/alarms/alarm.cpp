#include "bridges/alarms/alarm.h"

namespace alarms {

std::string_view name_of(AlarmKind kind) noexcept {
  switch (kind) {
    case AlarmKind::emcy:
      return "emcy";
    case AlarmKind::heartbeat:
      return "heartbeat";
    case AlarmKind::boot:
      return "boot";
    case AlarmKind::data:
      return "data";
    case AlarmKind::control:
      break;
  }
  return "control";
}

std::string_view name_of(config::Severity severity) noexcept {
  return severity == config::Severity::fault ? "fault" : "warning";
}

}  // namespace alarms
