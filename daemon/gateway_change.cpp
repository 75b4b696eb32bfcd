// How a gateway takes another configuration while it runs.

#include <fcntl.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <string>
#include <utility>

#include "bridges/process/plant_change.h"
#include "bridges/trace/feed.h"
#include "canopen/survey/bus_survey.h"
#include "daemon/gateway.h"
#include "daemon/recording.h"

namespace gateway {
namespace {

// Longer than any answer, or any thread's farewell, takes.
constexpr canopen::Duration kForgetAfter = std::chrono::minutes(2);

std::vector<std::size_t> leaving(const config::Difference::From& from, std::size_t count) {
  std::vector<std::size_t> leaving;
  for (std::size_t i = 0; i < count; ++i) {
    if (std::ranges::find(from, std::optional(i)) == from.end()) {
      leaving.push_back(i);
    }
  }
  return leaving;
}

void tell_gone_alarms(const process::Drive& drive) {
  for (const alarms::AlarmKind kind : alarms::kAlarmKinds) {
    if (const alarms::Alarm& alarm = drive.alarm(kind); alarm.known && alarm.active) {
      spdlog::warn("{}: alarm {} is gone with the drive: {}", drive.model().name, alarms::name_of(kind), alarm.text);
    }
  }
}

void tell_drives(const process::Plant& plant, const config::Model& now, const config::Difference& difference) {
  for (const std::size_t i : leaving(difference.drives, plant.size())) {
    const process::Drive& drive = plant.drive(i);
    const std::string& name = drive.model().name;
    if (drive.turning() == process::Turning::untold) {
      spdlog::warn("{}: nobody can tell whether its motor turns, as its profile has no `running`", name);
    }
    const auto at = config::find_named(now.drives, name);
    if (!at) {
      spdlog::info("reload: drive {} is removed", name);
      tell_gone_alarms(drive);
    } else {
      spdlog::info("reload: drive {} is changed", name);
      if (!now.drives[*at].enabled) {
        tell_gone_alarms(drive);
      }
    }
  }
  for (const config::Drive& drive : now.drives) {
    if (!config::find_named(plant.model().drives, drive.name)) {
      spdlog::info("reload: drive {} is new", drive.name);
    }
  }
}

void tell_buses(const process::Plant& plant, const config::Model& now, const config::Difference& difference) {
  for (const std::size_t i : leaving(difference.buses, plant.model().buses.size())) {
    const std::string& name = plant.model().buses[i].name;
    const bool removed = !config::find_named(now.buses, name);
    spdlog::info("reload: bus {} is {}", name, removed ? "removed" : "changed");
    if (const alarms::Alarm& alarm = plant.bus_alarm(i); removed && alarm.known && alarm.active) {
      spdlog::warn("bus {}: its alarm is gone with it: {}", name, alarm.text);
    }
  }
  for (const config::Bus& bus : now.buses) {
    if (!config::find_named(plant.model().buses, bus.name)) {
      spdlog::info("reload: bus {} is new", bus.name);
    }
  }
}

void tell_section(bool differs, std::string_view section, bool was, bool is) {
  if (differs) {
    spdlog::info("reload: [{}] {}", section, !was ? "is new" : is ? "is changed: it begins anew" : "is removed");
  }
}

void tell_sections(const config::Model& before, const config::Model& now, const config::Difference& difference) {
  tell_section(difference.modbus, "modbus", before.modbus.has_value(), now.modbus.has_value());
  tell_section(difference.mqtt, "mqtt", before.mqtt.has_value(), now.mqtt.has_value());
  tell_section(difference.http, "http", before.http.has_value(), now.http.has_value());
  tell_section(difference.recorder, "recorder", before.recorder.has_value(), now.recorder.has_value());
}

}  // namespace

boost::asio::awaitable<void> Gateway::change(std::shared_ptr<const config::Model> model) {
  const Model before = plant_.shared_model();  // Until nothing looks at it.
  const config::Difference difference = config::difference(*before, *model);
  Buses made(model->buses.size());
  for (std::size_t i = 0; i < made.size(); ++i) {
    // Before anything is touched: it may throw.
    made[i] = difference.buses[i] ? nullptr : make_bus(model->buses[i]);
  }
  tell_sections(*before, *model, difference);
  tell_buses(plant_, *model, difference);
  tell_drives(plant_, *model, difference);
  co_await stop_changed(difference);
  std::vector<std::size_t> drives = leaving(difference.drives, plant_.size());
  co_await plant_.stop(std::move(drives));
  for (const std::size_t i : leaving(difference.buses, buses_.size())) {
    co_await buses_[i]->stop();
  }
  // From here on nothing waits: nobody sees half of a change.
  change_plant(std::move(model), std::move(made), difference);
  make_changed(difference);
  fill_site();
  forget_.arm(canopen::Clock::now() + kForgetAfter);
}

boost::asio::awaitable<void> Gateway::stop_changed(const config::Difference& difference) {
  if (difference.http && http_) {
    co_await http_->stop();
    http_.reset();
    history_->stop();
  }
  if (difference.recorder && recording_) {
    recording_->stop_reading();
    co_await recording_->recorder().stop();
    plant_.remove(recording_->recorder());
    left_.push_back({.model = plant_.shared_model(), .recording = std::move(recording_), .mqtt = nullptr});
    fill_site();
  }
  if (difference.modbus && modbus_) {
    co_await modbus_->stop();
    plant_.remove(*modbus_);
    modbus_.reset();
    fill_site();
  }
  if (difference.mqtt && mqtt_) {
    co_await mqtt_->stop();
    plant_.remove(*mqtt_);
    left_.push_back({.model = mqtt_model_, .recording = nullptr, .mqtt = std::move(mqtt_)});
    plant_.set_other_gateway(false);
    fill_site();
  }
}

void Gateway::change_plant(Model model, Buses made, const config::Difference& difference) {
  for (const std::size_t i : leaving(difference.buses, buses_.size())) {
    left_buses_.push_back(std::move(buses_[i]));
  }
  const config::Model& now = *model;
  buses_ =
      process::realigned(std::move(buses_), difference.buses, [&made](std::size_t i) { return std::move(made[i]); });
  plant_.change(std::move(model), ports(), {.drives = difference.drives, .buses = difference.buses});
  trace_->change(now, bus_list(), difference.drives, difference.buses);
  if (recording_) {
    recording_->follow(ports(), difference.buses);
  }
  for (std::size_t i = 0; i < buses_.size(); ++i) {
    if (difference.buses[i]) {
      buses_[i]->move(plant_, i);
    } else {
      buses_[i]->follow(plant_, i);
      buses_[i]->start();
    }
  }
}

void Gateway::make_changed(const config::Difference& difference) {
  if (difference.recorder) {
    make_recorder();
    if (recording_) {
      recording_->recorder().start();
    }
  }
  if (difference.modbus) {
    make_modbus();
    std::vector<int> passed;
    for (const int kept : passed_) {
      if (const int descriptor = ::fcntl(kept, F_DUPFD_CLOEXEC, 0); modbus_ && descriptor >= 0) {
        passed.push_back(descriptor);
      }
    }
    start_modbus(passed);
  }
  if (difference.mqtt) {
    make_mqtt();
    if (mqtt_) {
      mqtt_->start();
    }
  }
  if (modbus_) {
    modbus_->set_mqtt_connected(mqtt_ && mqtt_->connected());
  }
  if (difference.http) {
    make_http();
    start_http();
  }
}

void Gateway::forget_left() {
  left_.clear();
  plant_.forget_left();
  left_buses_.clear();
}

}  // namespace gateway
