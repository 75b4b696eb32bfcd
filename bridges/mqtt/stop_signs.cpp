#include "bridges/mqtt/stop_signs.h"

#include <algorithm>
#include <utility>
#include <variant>

#include "bridges/mqtt/asked.h"
#include "bridges/mqtt/requests.h"
#include "bridges/process/command_checks.h"

namespace mqtt {

StopSigns::StopSigns(const config::Model& model, const Topics& topics) : topics_(topics) {
  change(model);
}

void StopSigns::change(const config::Model& model) {
  std::vector<config::Drive> drives;
  std::ranges::copy_if(model.drives, std::back_inserter(drives),
                       [](const config::Drive& drive) { return !process::refuse_writer(drive, mqtt_writer()); });
  const std::lock_guard lock(mutex_);
  drives_.swap(drives);
}

bool StopSigns::is_stop(const Incoming& incoming) const {
  const auto route = topics_.route(incoming.topic);
  if (!route || !carries_command(*route) || incoming.retained || incoming.payload.empty()) {
    return false;
  }
  if (route->kind == Route::Kind::stop_all) {
    return true;
  }
  const Parsed parsed = parse_command(*route, incoming.payload);
  const std::lock_guard lock(mutex_);
  const auto drive = std::ranges::find(drives_, route->drive, &config::Drive::name);
  if (drive == drives_.end()) {
    return false;
  }
  const auto asked = asked_of(&*drive, *route, parsed);
  return asked.has_value() && stops(*drive, asked.value());
}

}  // namespace mqtt
