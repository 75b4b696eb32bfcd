#include <vector>

#include "bridges/alarms/active_alarms_json.h"
#include "daemon/http/alarm_list.h"
#include "daemon/http/respond.h"

namespace gateway::http {

std::string active_alarms_text(const process::Plant& plant) {
  std::vector<alarms::ListedAlarm> listed;
  for (const process::ActiveAlarm& active : plant.active_alarms()) {
    if (active.drive != nullptr) {
      listed.push_back({.drive = active.drive->model().name, .kind = active.kind, .alarm = active.alarm});
    } else {
      listed.push_back({.bus = plant.model().buses[active.bus].name, .alarm = active.alarm});
    }
  }
  return alarms::active_alarms_json(listed);
}

Answer active_alarms(const Site& site) {
  return {.body = active_alarms_text(site.plant)};
}

}  // namespace gateway::http
