#include "bridges/alarms/data_problem.h"

namespace alarms {

std::string_view name_of(DataReason reason) noexcept {
  switch (reason) {
    case DataReason::overdue:
      return "overdue";
    case DataReason::unreadable:
      return "unreadable";
    case DataReason::too_short:
      return "short";
    case DataReason::absent:
      return "absent";
    case DataReason::emcy_off:
      return "emcy-off";
    case DataReason::emcy_moved:
      return "emcy-moved";
  }
  return "";
}

}  // namespace alarms
