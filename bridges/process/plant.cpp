#include "bridges/process/plant.h"

#include <algorithm>
#include <string>
#include <string_view>
#include <utility>

#include "bridges/process/observer.h"
#include "bridges/process/plant_body.h"

namespace process {

Plant::Plant(const boost::asio::any_io_executor& executor, std::shared_ptr<const config::Model> model,
             std::vector<BusPort> buses)
    : body_(std::make_unique<Body>(executor, std::move(model), std::move(buses))) {}

Plant::Plant(const boost::asio::any_io_executor& executor, const config::Model& model, std::vector<BusPort> buses)
    : Plant(executor, std::shared_ptr<const config::Model>(std::shared_ptr<void>(), &model), std::move(buses)) {}

Plant::~Plant() = default;

void Plant::add(Observer& observer) {
  body_->observers.push_back(&observer);
}

void Plant::remove(Observer& observer) {
  std::erase(body_->observers, &observer);
}

void Plant::set_journal(CommandJournal* journal) {
  body_->journal = journal;
  for (const Body::Place& place : body_->drives) {
    place.drive->set_journal(journal);
  }
}

void Plant::start() {
  for (const Body::Place& place : body_->drives) {
    place.drive->start();
  }
}

void Plant::close() {
  for (const Body::Place& place : body_->drives) {
    place.drive->close();
  }
}

boost::asio::awaitable<void> Plant::stop() {
  for (const Body::Place& place : body_->drives) {
    co_await place.drive->stop();
  }
}

const config::Model& Plant::model() const noexcept {
  return *body_->model;
}

const std::shared_ptr<const config::Model>& Plant::shared_model() const noexcept {
  return body_->model;
}

std::uint64_t Plant::changes() const noexcept {
  return body_->changes;
}

std::size_t Plant::size() const noexcept {
  return body_->drives.size();
}

Drive& Plant::drive(std::size_t index) noexcept {
  return *body_->drives[index].drive;
}

const Drive& Plant::drive(std::size_t index) const noexcept {
  return *body_->drives[index].drive;
}

Drive* Plant::find(std::string_view name) noexcept {
  return body_->find(name);
}

const Drive* Plant::find(std::string_view name) const noexcept {
  return body_->find(name);
}

std::size_t Plant::online() const noexcept {
  const auto& drives = body_->drives;
  return static_cast<std::size_t>(
      std::count_if(drives.begin(), drives.end(), [](const auto& place) { return place.drive->status().online; }));
}

std::size_t Plant::with_alarm() const noexcept {
  const auto& drives = body_->drives;
  return static_cast<std::size_t>(std::count_if(drives.begin(), drives.end(), [](const auto& place) {
    return place.drive->has_fault_alarm() || place.drive->has_warning_alarm();
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
  line.told = true;
  body_->show(bus);
  for (Observer* observer : body_->observers) {
    observer->on_bus(bus);
  }
}

void Plant::set_bus_troubles(std::size_t bus, const canopen::BusTroubles& troubles) {
  body_->lines[bus].troubles = troubles;
  body_->show(bus);
}

void Plant::set_other_gateway(bool lives) {
  body_->other_gateway = lives;
  for (std::size_t bus = 0; bus < body_->lines.size(); ++bus) {
    body_->show(bus);
  }
}

void Plant::set_bus_record(std::size_t bus, std::string name) {
  if (body_->lines[bus].alarm.set_record(std::move(name))) {
    body_->tell_bus_alarm(bus);
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

std::optional<alarms::FaultSource> Plant::first_out() const {
  return body_->first_out.newest_group();
}

void Plant::restore_first_out(const alarms::FaultSource& newest) {
  body_->first_out.restore(newest);
}

std::vector<ActiveAlarm> Plant::active_alarms() const {
  std::vector<ActiveAlarm> active;
  const auto add = [&active](const ActiveAlarm& one) {
    if (one.alarm->known && one.alarm->active) {
      const auto later =
          std::upper_bound(active.begin(), active.end(), one,
                           [](const ActiveAlarm& a, const ActiveAlarm& b) { return a.alarm->since < b.alarm->since; });
      active.insert(later, one);
    }
  };
  for (const Body::Place& place : body_->drives) {
    for (const alarms::AlarmKind kind : alarms::kAlarmKinds) {
      add({.drive = place.drive.get(), .kind = kind, .alarm = &place.drive->alarm(kind)});
    }
  }
  for (std::size_t bus = 0; bus < body_->lines.size(); ++bus) {
    add({.bus = bus, .alarm = &bus_alarm(bus)});
  }
  return active;
}

}  // namespace process
