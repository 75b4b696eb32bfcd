#include "bridges/alarms/control_alarm.h"

namespace alarms {

std::string_view name_of(ControlReason reason) noexcept {
  switch (reason) {
    case ControlReason::timeout:
      return "timeout";
    case ControlReason::timeout_failed:
      return "timeout-failed";
    case ControlReason::feedback:
      break;
  }
  return "feedback";
}

}  // namespace alarms
