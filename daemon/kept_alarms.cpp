#include "daemon/kept_alarms.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <utility>

#include "bridges/process/plant_change.h"

namespace gateway {

KeptAlarms::KeptAlarms(const boost::asio::any_io_executor& executor, process::Plant& plant)
    : plant_(plant),
      keeper_(executor, {.directory = plant.model().gateway.state_dir},
              [](const std::string& text) { spdlog::warn("alarms: {}", text); }),
      drives_(plant.size()),
      buses_(plant.model().buses.size()) {}

void KeptAlarms::restore() {
  const alarms::AlarmMemory memory = keeper_.load();
  for (const alarms::AlarmMemory::OfDrive& before : memory.drives) {
    process::Drive* drive = plant_.find(before.name);
    for (const alarms::AlarmKind kind : alarms::kAlarmKinds) {
      const auto& alarm = before.alarms.at(static_cast<std::size_t>(kind));
      if (drive != nullptr && alarm) {
        drive->restore(kind, *alarm);
      }
    }
  }
  const std::vector<config::Bus>& buses = plant_.model().buses;
  for (const alarms::AlarmMemory::OfBus& before : memory.buses) {
    const auto bus = std::ranges::find(buses, before.name, &config::Bus::name);
    if (bus != buses.end()) {
      plant_.restore_bus_alarm(static_cast<std::size_t>(bus - buses.begin()), before.alarm);
    }
  }
  if (memory.newest_first) {
    restore_first(*memory.newest_first);
  }
  restored_ = true;
  keeper_.start([this] { return snapshot(); });
}

void KeptAlarms::restore_first(const alarms::NamedFault& first) {
  if (first.bus.empty()) {
    if (const process::Drive* drive = plant_.find(first.drive)) {
      plant_.restore_first_out({.bus = false, .index = drive->index(), .kind = first.kind});
    }
    return;
  }
  const std::vector<config::Bus>& buses = plant_.model().buses;
  const auto bus = std::ranges::find(buses, first.bus, &config::Bus::name);
  if (bus != buses.end()) {
    plant_.restore_first_out({.bus = true, .index = static_cast<std::size_t>(bus - buses.begin())});
  }
}

void KeptAlarms::on_alarm(const process::Drive& drive, alarms::AlarmKind kind) {
  note(drive.alarm(kind), drives_[drive.index()].at(static_cast<std::size_t>(kind)));
}

void KeptAlarms::on_bus_alarm(std::size_t bus) {
  note(plant_.bus_alarm(bus), buses_[bus]);
}

void KeptAlarms::on_plant_change(const process::PlantChange& change) {
  drives_ = process::realigned(std::move(drives_), change.drives, [](std::size_t) { return OfDrive{}; });
  buses_ = process::realigned(std::move(buses_), change.buses, [](std::size_t) { return Activation{}; });
  keeper_.on_begin_or_end();
}

void KeptAlarms::note(const alarms::Alarm& alarm, Activation& before) {
  Activation now{alarm.active, alarm.id};
  const bool same = before == now;
  before = std::move(now);
  if (!restored_) {
    return;
  }
  if (same) {
    keeper_.on_change();
  } else {
    keeper_.on_begin_or_end();
  }
}

alarms::AlarmMemory KeptAlarms::snapshot() const {
  const config::Model& model = plant_.model();
  alarms::AlarmMemory memory;
  memory.gateway = model.gateway.name;
  for (std::size_t i = 0; i < plant_.size(); ++i) {
    const process::Drive& drive = plant_.drive(i);
    if (!drive.model().enabled) {
      continue;
    }
    alarms::AlarmMemory::OfDrive& kept = memory.drives.emplace_back();
    kept.name = drive.model().name;
    for (const alarms::AlarmKind kind : alarms::kAlarmKinds) {
      if (drive.alarm(kind).known) {
        kept.alarms.at(static_cast<std::size_t>(kind)) = drive.alarm(kind);
      }
    }
  }
  for (std::size_t i = 0; i < model.buses.size(); ++i) {
    if (plant_.bus_alarm(i).known) {
      memory.buses.push_back({model.buses[i].name, plant_.bus_alarm(i)});
    }
  }
  if (const auto first = plant_.first_out()) {
    memory.newest_first =
        first->bus ? alarms::NamedFault{.drive = {}, .bus = model.buses[first->index].name}
                   : alarms::NamedFault{.drive = model.drives[first->index].name, .bus = {}, .kind = first->kind};
  }
  return memory;
}

}  // namespace gateway
