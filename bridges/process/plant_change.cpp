#include "bridges/process/plant_change.h"

#include <string>
#include <utility>

#include "bridges/process/observer.h"
#include "bridges/process/plant_body.h"
#include "config/model.h"

namespace process {
boost::asio::awaitable<void> Plant::stop(std::vector<std::size_t> drives) {
  for (const std::size_t i : drives) {
    body_->drives[i].drive->close();  // All at once: a stop of one may take as long as a transfer.
  }
  for (const std::size_t i : drives) {
    co_await body_->drives[i].drive->stop();
  }
}

void Plant::change(std::shared_ptr<const config::Model> model, std::vector<BusPort> buses, const PlantChange& from) {
  Body& body = *body_;
  const std::shared_ptr<const config::Model> before = std::exchange(body.model, std::move(model));
  ++body.changes;
  const Body::Inherited inherited = body.inherit(*before, from);
  body.lines = realigned(std::move(body.lines), from.buses, [](std::size_t) { return Body::Line{}; });
  for (std::size_t i = 0; i < buses.size(); ++i) {
    body.lines[i].port = std::move(buses[i]);
  }
  body.replace_drives(from);
  for (Observer* observer : body.observers) {
    observer->on_plant_change(from);
  }
  for (const auto& [bus, alarm] : inherited.of_buses) {
    restore_bus_alarm(bus, alarm);
  }
  for (const auto& [drive, kind, alarm] : inherited.of_drives) {
    body.drives[drive].drive->restore(kind, alarm);
  }
  for (std::size_t bus = 0; bus < body.lines.size(); ++bus) {
    body.show(bus);  // A drive that left may have been one of two with its node id.
  }
  for (std::size_t i = 0; i < body.drives.size(); ++i) {
    if (!from.drives[i]) {
      body.drives[i].drive->start();
    }
  }
}

Plant::Body::Inherited Plant::Body::inherit(const config::Model& before, const PlantChange& from) {
  first_out.move([this, &before](const alarms::FaultSource& source) -> std::optional<alarms::FaultSource> {
    const auto at = source.bus ? config::find_named(model->buses, before.buses[source.index].name)
                               : config::find_named(model->drives, before.drives[source.index].name);
    return at ? std::optional(alarms::FaultSource{.bus = source.bus, .index = *at, .kind = source.kind}) : std::nullopt;
  });
  Inherited inherited;
  for (std::size_t i = 0; i < model->buses.size(); ++i) {
    const auto same_name = config::find_named(before.buses, model->buses[i].name);
    if (!from.buses[i] && same_name && lines[*same_name].alarm.alarm().known) {
      inherited.of_buses.emplace_back(i, lines[*same_name].alarm.alarm());
    }
  }
  for (std::size_t i = 0; i < model->drives.size(); ++i) {
    const auto same_name = config::find_named(before.drives, model->drives[i].name);
    for (const alarms::AlarmKind kind : alarms::kAlarmKinds) {
      if (!from.drives[i] && same_name && drives[*same_name].drive->alarm(kind).known) {
        inherited.of_drives.emplace_back(i, kind, drives[*same_name].drive->alarm(kind));
      }
    }
  }
  return inherited;
}

void Plant::Body::replace_drives(const PlantChange& from) {
  std::vector<Place> before = std::move(drives);
  drives.clear();
  for (std::size_t i = 0; i < from.drives.size(); ++i) {
    if (from.drives[i]) {
      drives.push_back(std::move(before[*from.drives[i]]));
      drives.back().drive->set_place(i, model->drives[i].bus);
    } else {
      drives.push_back(make_drive(i));
    }
  }
  for (Place& place : before) {
    if (place.drive) {
      place.drive->leave();
      left.push_back(std::move(place));
    }
  }
}

void Plant::forget_left() {
  body_->left.clear();
}

}  // namespace process
