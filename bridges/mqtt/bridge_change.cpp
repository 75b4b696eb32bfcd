// What becomes of the bridge when the plant changes while it runs. The connection and its subscriptions stay.

#include <utility>

#include "bridges/mqtt/bridge.h"
#include "bridges/process/plant_change.h"

namespace mqtt {

void Bridge::on_plant_change(const process::PlantChange& change) {
  const canopen::TimePoint now = canopen::Clock::now();
  const config::Model& model = plant_.model();
  if (session_.ready()) {
    say_last_of_gone(change);
  }
  topics_.change(model, change);
  feeds_ = process::realigned(std::move(feeds_), change.drives,
                              [this](std::size_t i) { return Feed(plant_.drive(i), topics_.drive(i), settings_); });
  alarms_.change(change, now);
  requests_.change(change);
  home_assistant_.change(model, change, now);
  leftovers_.change(model, now);
  if (session_.ready()) {
    batch_.push_back(info());
    health_may_differ();
    wake(now);
  }
}

void Bridge::say_last_of_gone(const process::PlantChange& change) {
  for (const std::size_t i : process::left_behind(change.drives, feeds_.size())) {
    if (plant_.find(feeds_[i].drive_name()) == nullptr) {
      feeds_[i].collect_last(batch_);
    }
  }
}

}  // namespace mqtt
