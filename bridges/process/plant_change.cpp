#include "bridges/process/plant_change.h"

#include <string>
#include <utility>

#include "bridges/process/observer.h"
#include "bridges/process/plant_body.h"
#include "config/difference.h"

namespace process {
namespace {

using KnownAlarms = std::vector<std::pair<alarms::AlarmKind, alarms::Alarm>>;

KnownAlarms known_alarms(const Drive& drive) {
  KnownAlarms known;
  for (const alarms::AlarmKind kind : alarms::kAlarmKinds) {
    if (drive.alarm(kind).known) {
      known.emplace_back(kind, drive.alarm(kind));
    }
  }
  return known;
}

}  // namespace

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
  const config::Model& now = *body.model;
  ++body.changes;
  // A flag of an alarm belongs to what has its name.
  body.first_out.move([&before, &now](const alarms::FaultSource& source) -> std::optional<alarms::FaultSource> {
    const auto at = source.bus ? config::find_named(now.buses, before->buses[source.index].name)
                               : config::find_named(now.drives, before->drives[source.index].name);
    return at ? std::optional(alarms::FaultSource{.bus = source.bus, .index = *at, .kind = source.kind}) : std::nullopt;
  });
  std::vector<std::optional<alarms::Alarm>> of_buses(now.buses.size());
  std::vector<KnownAlarms> of_drives(now.drives.size());
  for (std::size_t i = 0; i < now.buses.size(); ++i) {
    const auto same_name = config::find_named(before->buses, now.buses[i].name);
    if (!from.buses[i] && same_name && body.lines[*same_name].alarm.alarm().known) {
      of_buses[i] = body.lines[*same_name].alarm.alarm();
    }
  }
  for (std::size_t i = 0; i < now.drives.size(); ++i) {
    const auto same_name = config::find_named(before->drives, now.drives[i].name);
    if (!from.drives[i] && same_name) {
      of_drives[i] = known_alarms(*body.drives[*same_name].drive);
    }
  }
  body.lines = realigned(std::move(body.lines), from.buses, [](std::size_t) { return Body::Line{}; });
  for (std::size_t i = 0; i < buses.size(); ++i) {
    body.lines[i].port = std::move(buses[i]);
  }
  body.replace_drives(from);
  for (Observer* observer : body.observers) {
    observer->on_plant_change(from);
  }
  for (std::size_t i = 0; i < of_buses.size(); ++i) {
    if (of_buses[i]) {
      restore_bus_alarm(i, *of_buses[i]);
    }
  }
  for (std::size_t i = 0; i < of_drives.size(); ++i) {
    for (const auto& [kind, alarm] : of_drives[i]) {
      body.drives[i].drive->restore(kind, alarm);
    }
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
