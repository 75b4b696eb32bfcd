#include "bridges/process/plant.h"

#include <algorithm>
#include <string>
#include <utility>

#include "bridges/alarms/alarm_record.h"
#include "bridges/process/observer.h"

namespace process {
class Plant::Body {
 public:
  struct Line {
    BusPort port;
    canopen::BusState state;
    alarms::AlarmRecord alarm;
  };

  Body(const boost::asio::any_io_executor& executor, const config::Model& plant_model, std::vector<BusPort> buses)
      : model(plant_model) {
    for (std::size_t i = 0; i < buses.size(); ++i) {
      lines.push_back({std::move(buses[i]), {}, alarms::AlarmRecord()});
    }
    for (std::size_t i = 0; i < model.drives.size(); ++i) {
      const config::Drive& drive = model.drives[i];
      drives.push_back(std::make_unique<Drive>(executor, drive, i, *lines[drive.bus].port.bus, observers));
    }
  }

  const config::Model& model;
  std::vector<Observer*> observers;
  std::vector<Line> lines;
  std::vector<std::unique_ptr<Drive>> drives;
};

Plant::Plant(boost::asio::any_io_executor executor, const config::Model& model, std::vector<BusPort> buses)
    : body_(std::make_unique<Body>(executor, model, std::move(buses))) {}

Plant::~Plant() = default;

void Plant::add(Observer& observer) {
  body_->observers.push_back(&observer);
}

void Plant::start() {
  for (const auto& drive : body_->drives) {
    drive->start();
  }
}

void Plant::close() {
  for (const auto& drive : body_->drives) {
    drive->close();
  }
}

boost::asio::awaitable<void> Plant::stop() {
  for (const auto& drive : body_->drives) {
    co_await drive->stop();
  }
}

const config::Model& Plant::model() const noexcept {
  return body_->model;
}

std::size_t Plant::size() const noexcept {
  return body_->drives.size();
}

Drive& Plant::drive(std::size_t index) noexcept {
  return *body_->drives[index];
}

const Drive& Plant::drive(std::size_t index) const noexcept {
  return *body_->drives[index];
}

Drive* Plant::find(std::string_view name) noexcept {
  const auto& drives = body_->drives;
  const auto found =
      std::find_if(drives.begin(), drives.end(), [=](const auto& drive) { return drive->model().name == name; });
  return found == drives.end() ? nullptr : found->get();
}

std::size_t Plant::online() const noexcept {
  const auto& drives = body_->drives;
  return static_cast<std::size_t>(
      std::count_if(drives.begin(), drives.end(), [](const auto& drive) { return drive->status().online; }));
}

std::size_t Plant::with_alarm() const noexcept {
  const auto& drives = body_->drives;
  return static_cast<std::size_t>(std::count_if(drives.begin(), drives.end(), [](const auto& drive) {
    return drive->has_fault_alarm() || drive->has_warning_alarm();
  }));
}

void Plant::restore_bus_alarm(std::size_t bus, const alarms::Alarm& before) {
  body_->lines[bus].alarm.restore(before);
  if (!before.active) {
    return;
  }
  for (Observer* observer : body_->observers) {
    observer->on_bus_alarm(bus);
  }
}

void Plant::set_bus_state(std::size_t bus, const canopen::BusState& state) {
  Body::Line& line = body_->lines[bus];
  line.state = state;
  const bool active = state.condition != canopen::BusCondition::error_active;
  const bool changed =
      line.alarm.show(active, std::string(canopen::describe(state.condition)),
                      state.up() ? config::Severity::warning : config::Severity::fault, canopen::wall_now());
  for (Observer* observer : body_->observers) {
    observer->on_bus(bus);
    if (changed) {
      observer->on_bus_alarm(bus);
    }
  }
}

const canopen::BusState& Plant::bus_state(std::size_t bus) const noexcept {
  return body_->lines[bus].state;
}

canopen::BusStatistics Plant::bus_statistics(std::size_t bus) const {
  const BusPort& port = body_->lines[bus].port;
  return port.statistics ? port.statistics() : canopen::BusStatistics{};
}

const alarms::Alarm& Plant::bus_alarm(std::size_t bus) const noexcept {
  return body_->lines[bus].alarm.alarm();
}

std::vector<ActiveAlarm> Plant::active_alarms() const {
  std::vector<ActiveAlarm> active;
  const auto add = [&active](const ActiveAlarm& one) {
    if (one.alarm->known && one.alarm->active) {
      active.push_back(one);
    }
  };
  for (const auto& drive : body_->drives) {
    for (const alarms::AlarmKind kind : alarms::kAlarmKinds) {
      add({.drive = drive.get(), .kind = kind, .alarm = &drive->alarm(kind)});
    }
  }
  for (std::size_t bus = 0; bus < body_->lines.size(); ++bus) {
    add({.bus = bus, .alarm = &bus_alarm(bus)});
  }
  std::stable_sort(active.begin(), active.end(),
                   [](const ActiveAlarm& a, const ActiveAlarm& b) { return a.alarm->since < b.alarm->since; });
  return active;
}

}  // namespace process
