#include "bridges/mqtt/stop_signs.h"

#include <algorithm>
#include <utility>

#include "bridges/mqtt/asked.h"
#include "bridges/mqtt/requests.h"
#include "bridges/process/command_checks.h"

namespace mqtt {

StopSigns::StopSigns(std::shared_ptr<const config::Model> model, const Topics& topics)
    : topics_(topics), model_(std::move(model)) {}

void StopSigns::change(std::shared_ptr<const config::Model> model) {
  const std::lock_guard lock(mutex_);
  model_.swap(model);
}

bool StopSigns::is_stop(const Incoming& incoming) const {
  const auto route = topics_.route(incoming.topic);
  if (!route || !carries_command(*route) || incoming.retained || incoming.payload.empty()) {
    return false;
  }
  if (route->kind == Route::Kind::stop_all) {
    return true;
  }
  const std::shared_ptr<const config::Model> model = [this] {
    const std::lock_guard lock(mutex_);
    return model_;
  }();
  const auto drive = std::ranges::find(model->drives, route->drive, &config::Drive::name);
  if (drive == model->drives.end() || process::refuse_writer(*drive, mqtt_writer())) {
    return false;
  }
  const auto asked = asked_of(&*drive, *route, parse_command(*route, incoming.payload));
  return asked.has_value() && stops(*drive, asked.value());
}

}  // namespace mqtt
