#include "daemon/gateway.h"

#include <spdlog/spdlog.h>
#include <unistd.h>

#include <string>
#include <utility>

#include "bridges/alarms/alarm_id.h"
#include "bridges/modbus/passed_sockets.h"
#include "bridges/trace/feed.h"
#include "canopen/survey/bus_survey.h"
#include "daemon/journal_place.h"
#include "daemon/program_health.h"
#include "daemon/recording.h"

namespace gateway {
namespace {

// For clients of the control socket that do not read their answers at the end.
constexpr canopen::Duration kControlPatience = std::chrono::milliseconds(200);

std::unique_ptr<journal::Journal> make_journal(const boost::asio::any_io_executor& executor,
                                               const config::Gateway& gateway) {
  if (gateway.state_dir.empty()) {
    return nullptr;
  }
  return std::make_unique<journal::Journal>(executor, journal_place(gateway),
                                            [](const std::string& text) { spdlog::warn("journal: {}", text); });
}

}  // namespace

Gateway::Gateway(boost::asio::any_io_executor executor, std::shared_ptr<const config::Model> model,
                 LinkFactory make_link, const std::string& control_group)
    : executor_(std::move(executor)),
      make_link_(std::move(make_link)),
      instance_(alarms::random_id()),
      journal_(make_journal(executor_, model->gateway)),
      buses_(make_buses(*this, *model)),
      plant_(executor_, model, ports()),
      event_log_(executor_, plant_),
      forget_(executor_, [this] { forget_left(); }) {
  plant_.set_journal(journal_.get());
  plant_.add(event_log_);
  if (model->gateway.state_dir.empty()) {
    spdlog::warn("state_dir is empty: alarms and commands are not kept over a restart");
  } else {
    kept_alarms_ = std::make_unique<KeptAlarms>(executor_, plant_);
    plant_.add(*kept_alarms_);
  }
  make_recorder();
  make_modbus();
  make_mqtt();
  trace_ = std::make_unique<trace::Feed>(plant_.model(), bus_list());
  if (!model->gateway.control.empty()) {
    make_control(control_group);
  }
  make_http();
  for (std::size_t i = 0; i < buses_.size(); ++i) {
    buses_[i]->follow(plant_, i);
  }
}

Gateway::Gateway(boost::asio::any_io_executor executor, const config::Model& model, LinkFactory make_link,
                 const std::string& control_group)
    : Gateway(std::move(executor), std::shared_ptr<const config::Model>(std::shared_ptr<void>(), &model),
              std::move(make_link), control_group) {}

Gateway::~Gateway() {
  for (const int descriptor : passed_) {
    ::close(descriptor);
  }
}

std::unique_ptr<BusInUse> Gateway::make_bus(const config::Bus& settings) const {
  return std::make_unique<BusInUse>(executor_, settings, make_link_(settings));
}

Gateway::Buses Gateway::make_buses(const Gateway& gateway, const config::Model& model) {
  Buses buses;
  for (const config::Bus& bus : model.buses) {
    buses.push_back(gateway.make_bus(bus));
  }
  return buses;
}

std::vector<process::Plant::BusPort> Gateway::ports() const {
  std::vector<process::Plant::BusPort> ports;
  for (const auto& in_use : buses_) {
    ports.push_back(in_use->port());
  }
  return ports;
}

std::vector<canopen::Bus*> Gateway::bus_list() const {
  std::vector<canopen::Bus*> buses;
  for (const auto& in_use : buses_) {
    buses.push_back(&in_use->bus());
  }
  return buses;
}

process::Health Gateway::health() const {
  process::Health health = process::health_of(plant_);
  health.instance = instance_;
  health.program = program_health(started_, journal_ ? journal_->newest_hash() : std::string());
  if (mqtt_) {
    health.broker = mqtt_->broker_health();
  }
  return health;
}

void Gateway::start(std::span<const int> passed) {
  if (kept_alarms_) {
    kept_alarms_->restore();
  }
  if (recording_) {
    recording_->recorder().start();
  }
  if (journal_) {
    journal_->start();
  }
  passed_ = modbus::duplicates_of(passed);
  start_modbus(passed);
  if (mqtt_) {
    mqtt_->start();
  }
  if (control_) {
    control_->start();
  }
  start_http();
  plant_.start();
  for (const auto& in_use : buses_) {
    in_use->start();
  }
}

// No command begins any more; those that have begun still get their answer on MQTT and the control socket. Modbus
// clients are gone at once, and what they began ends with the plant.
boost::asio::awaitable<void> Gateway::stop() {
  forget_.cancel();
  if (recording_) {
    recording_->stop_reading();
  }
  if (http_) {
    history_->stop();
    co_await http_->stop();
  }
  if (modbus_) {
    modbus_->close();
  }
  if (control_) {
    control_->close();
  }
  plant_.close();
  if (mqtt_) {
    co_await mqtt_->stop();
  }
  co_await plant_.stop();
  if (control_) {
    co_await control_->stop(kControlPatience);
  }
  if (modbus_) {
    co_await modbus_->stop();
  }
  co_await stop_left();
  for (const auto& in_use : buses_) {
    co_await in_use->stop();
  }
  event_log_.finish();
  if (recording_) {
    co_await recording_->recorder().stop();
  }
  if (kept_alarms_) {
    co_await kept_alarms_->stop();
  }
  if (journal_) {
    co_await journal_->stop();
  }
}

}  // namespace gateway
