// How a gateway takes another configuration while it runs.

#include <spdlog/spdlog.h>

#include <algorithm>
#include <exception>
#include <string>
#include <utility>

#include "bridges/modbus/passed_sockets.h"
#include "bridges/process/plant_change.h"
#include "bridges/trace/feed.h"
#include "canopen/survey/bus_survey.h"
#include "daemon/gateway.h"
#include "daemon/recording.h"

namespace gateway {
namespace {

// Longer than any answer, or any thread's farewell, takes.
constexpr canopen::Duration kForgetAfter = std::chrono::minutes(2);

void tell_gone_alarms(const process::Drive& drive) {
  for (const alarms::AlarmKind kind : alarms::kAlarmKinds) {
    if (const alarms::Alarm& alarm = drive.alarm(kind); alarm.known && alarm.active) {
      spdlog::warn("{}: alarm {} is gone with the drive: {}", drive.model().name, alarms::name_of(kind), alarm.text);
    }
  }
}

void tell_drives(const process::Plant& plant, const config::Model& now, const config::Difference& difference) {
  for (const std::size_t i : process::left_behind(difference.drives, plant.size())) {
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
  for (const std::size_t i : process::left_behind(difference.buses, plant.model().buses.size())) {
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

void tell_section(std::string_view section, bool was, bool is) {
  spdlog::info("reload: [{}] {}", section, !was ? "is new" : is ? "is changed: it begins anew" : "is removed");
}

constexpr const char* kNewSection = "disconnected: its section of the configuration was changed";

}  // namespace

template <class Section>
void Gateway::take_section(Section config::Model::* section, const config::Model& wanted) {
  config::Model next = plant_.model();
  next.*section = wanted.*section;
  take(std::make_shared<const config::Model>(std::move(next)), Buses(buses_.size()));
}

boost::asio::awaitable<void> Gateway::change_sections(const config::Model& wanted) {
  const config::Difference difference = config::difference(plant_.model(), wanted);
  if (difference.http) {
    change_http(wanted);
  }
  if (difference.recorder && !ending_) {
    co_await change_recorder(wanted);
  }
  if (difference.mqtt && !ending_) {
    co_await change_mqtt(wanted);
  }
}

// Who is served by the old one still is, and sees the end of his connection.
void Gateway::change_http(const config::Model& wanted) {
  tell_section("http", plant_.model().http.has_value(), wanted.http.has_value());
  if (http_) {
    http_->close(kNewSection);
    history_->stop();
    leave({.model = http_model_, .http = std::move(http_)});
  }
  take_section(&config::Model::http, wanted);
  make_http();
  start_http();
}

boost::asio::awaitable<void> Gateway::change_recorder(const config::Model& wanted) {
  tell_section("recorder", plant_.model().recorder.has_value(), wanted.recorder.has_value());
  if (recording_) {
    recording_->stop_reading();
    co_await recording_->recorder().stop();
    plant_.remove(recording_->recorder());
    leave({.model = plant_.shared_model(), .recording = std::move(recording_)});
    fill_site();
  }
  if (ending_) {
    co_return;
  }
  take_section(&config::Model::recorder, wanted);
  make_recorder();
  if (recording_) {
    recording_->recorder().start();
  }
  fill_site();
}

// Two of one client id would throw each other out: the old one has to be gone.
boost::asio::awaitable<void> Gateway::change_mqtt(const config::Model& wanted) {
  tell_section("mqtt", plant_.model().mqtt.has_value(), wanted.mqtt.has_value());
  if (mqtt_) {
    co_await mqtt_->stop();
    plant_.remove(*mqtt_);
    leave({.model = mqtt_model_, .mqtt = std::move(mqtt_)});
    plant_.set_other_gateway(false);
    fill_site();
  }
  if (ending_) {
    co_return;
  }
  take_section(&config::Model::mqtt, wanted);
  make_mqtt();
  if (mqtt_) {
    mqtt_->start();
  }
  if (modbus_) {
    modbus_->set_mqtt_connected(mqtt_ && mqtt_->connected());
  }
  fill_site();
}

boost::asio::awaitable<void> Gateway::change(std::shared_ptr<const config::Model> model) {
  const config::Difference difference = config::difference(plant_.model(), *model);
  Buses made = make_new_buses(*model);  // Before anything is touched: it may throw.
  std::vector<std::size_t> drives = process::left_behind(difference.drives, plant_.size());
  tell_buses(plant_, *model, difference);
  tell_drives(plant_, *model, difference);
  // Nothing has waited until here: whoever asked for this has just seen that they stand still. This closes all at once.
  co_await plant_.stop(std::move(drives));
  for (const std::size_t i : process::left_behind(difference.buses, buses_.size())) {
    co_await buses_[i]->stop();
  }
  if (ending_) {
    co_return;
  }
  // From here on nothing waits: nobody sees half of a change, and Modbus is always there for a stop.
  if (difference.modbus) {
    tell_section("modbus", plant_.model().modbus.has_value(), model->modbus.has_value());
    if (modbus_) {
      modbus_->close(kNewSection);
      plant_.remove(*modbus_);
      leave({.model = modbus_model_, .modbus = std::move(modbus_)});
    }
  }
  take(std::move(model), std::move(made));
  if (difference.modbus) {
    begin_modbus();
  }
  fill_site();
  forget_.arm(canopen::Clock::now() + kForgetAfter);
}

void Gateway::begin_modbus() {
  make_modbus();
  start_modbus(modbus::duplicates_of(passed_));
  if (modbus_) {
    modbus_->set_mqtt_connected(mqtt_ && mqtt_->connected());
  }
}

Gateway::Buses Gateway::make_new_buses(const config::Model& model) const {
  const config::Difference difference = config::difference(plant_.model(), model);
  Buses made(model.buses.size());
  for (std::size_t i = 0; i < made.size(); ++i) {
    made[i] = difference.buses[i] ? nullptr : make_bus(model.buses[i]);
  }
  return made;
}

void Gateway::take(Model model, Buses made) {
  const Model before = plant_.shared_model();  // Until nothing looks at it.
  const config::Difference difference = config::difference(*before, *model);
  for (const std::size_t i : process::left_behind(difference.buses, buses_.size())) {
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
      start_bus(i);
    }
  }
}

// Where no descriptor is left this throws, which is no reason to leave the other buses alone.
void Gateway::start_bus(std::size_t bus) {
  try {
    buses_[bus]->start();
  } catch (const std::exception& failure) {
    spdlog::critical("bus {}: it cannot be opened: {}; restart the gateway", plant_.model().buses[bus].name,
                     failure.what());
    plant_.set_bus_state(bus, canopen::BusState{});
  }
}

void Gateway::leave(Left left) {
  left_.push_back(std::move(left));
  forget_.arm(canopen::Clock::now() + kForgetAfter);
}

// Whoever has not ended yet, a thread that hangs above all, would keep the loop waiting, and may look at what left.
void Gateway::forget_left() {
  std::erase_if(left_, [](const Left& left) {
    return (!left.recording || left.recording->ended()) && (!left.modbus || left.modbus->ended()) &&
           (!left.mqtt || left.mqtt->ended()) && (!left.http || left.http->ended());
  });
  if (!left_.empty()) {
    forget_.arm(canopen::Clock::now() + kForgetAfter);
    return;
  }
  plant_.forget_left();
  left_buses_.clear();
}

boost::asio::awaitable<void> Gateway::stop_left() {
  for (const Left& left : left_) {
    if (left.modbus) {
      co_await left.modbus->stop();
    }
    if (left.http) {
      co_await left.http->stop();
    }
  }
}

}  // namespace gateway
