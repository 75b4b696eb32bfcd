#include "daemon/gateway.h"

#include <spdlog/spdlog.h>
#include <unistd.h>

#include <deque>
#include <string>
#include <utility>

#include "bridges/alarms/alarm_id.h"
#include "bridges/mqtt/publisher.h"
#include "bridges/trace/feed.h"
#include "canopen/survey/bus_survey.h"
#include "daemon/control/plant_service.h"
#include "daemon/control/streams.h"
#include "daemon/http/respond.h"
#include "daemon/journal_place.h"
#include "daemon/log.h"
#include "daemon/map.h"
#include "daemon/program_health.h"
#include "daemon/recording.h"
#include "daemon/surveys.h"

namespace gateway {
namespace {

canopen::BusSettings settings_of(const config::Bus& bus) {
  canopen::BusSettings settings;
  settings.bitrate = bus.bitrate;
  settings.node_id = bus.node_id;
  settings.heartbeat = bus.heartbeat;
  settings.sync = bus.sync;
  settings.sdo_load = bus.sdo_load;
  return settings;
}

// For clients of the control socket that do not read their answers at the end.
constexpr canopen::Duration kControlPatience = std::chrono::milliseconds(200);

// Notices say themselves that they are about MQTT.
void log_notice(mqtt::Level level, const std::string& text) {
  switch (level) {
    case mqtt::Level::info:
      spdlog::info(text);
      break;
    case mqtt::Level::warning:
      spdlog::warn(text);
      break;
    case mqtt::Level::error:
      spdlog::error(text);
      break;
  }
}

void close_unused(std::span<const int> passed) {
  if (!passed.empty()) {
    spdlog::warn("the service manager passed sockets, but there is no [modbus], so they are closed");
  }
  for (const int descriptor : passed) {
    ::close(descriptor);
  }
}

std::unique_ptr<journal::Journal> make_journal(const boost::asio::any_io_executor& executor,
                                               const config::Gateway& gateway) {
  if (gateway.state_dir.empty()) {
    return nullptr;
  }
  return std::make_unique<journal::Journal>(executor, journal_place(gateway),
                                            [](const std::string& text) { spdlog::warn("journal: {}", text); });
}

}  // namespace

Gateway::Gateway(boost::asio::any_io_executor executor, const config::Model& model, const LinkFactory& make_link,
                 const std::string& control_group)
    : instance_(alarms::random_id()),
      journal_(make_journal(executor, model.gateway)),
      buses_(make_buses(executor, model, make_link)),
      plant_(executor, model, ports(buses_)),
      event_log_(executor, plant_) {
  for (std::size_t i = 0; journal_ && i < plant_.size(); ++i) {
    plant_.drive(i).set_journal(journal_.get());
  }
  plant_.add(event_log_);
  if (model.gateway.state_dir.empty()) {
    spdlog::warn("state_dir is empty: alarms and commands are not kept over a restart");
  } else {
    kept_alarms_ = std::make_unique<KeptAlarms>(executor, plant_);
    plant_.add(*kept_alarms_);
    recording_ = make_recording(executor, plant_, ports(buses_));
  }
  if (model.modbus) {
    modbus_ =
        std::make_unique<modbus::Server>(executor, plant_, *model.modbus,
                                         net::Notices{.info = [](const std::string& text) { spdlog::info(text); },
                                                      .warning = [](const std::string& text) { spdlog::warn(text); }});
    modbus_->count_lost_messages_by(&Log::dropped);
    plant_.add(*modbus_);
  }
  if (model.mqtt) {
    mqtt_ = std::make_unique<mqtt::Bridge>(
        executor, plant_, *model.mqtt, model.gateway, GATEWAY_VERSION, instance_,
        std::make_unique<mqtt::Publisher>(executor, mqtt::publisher_settings(*model.mqtt, model.gateway), log_notice),
        log_notice);
    plant_.add(*mqtt_);
    mqtt_->tell_program_health_by(
        [this] { return program_health(started_, journal_ ? journal_->newest_hash() : std::string()); });
    if (modbus_) {
      mqtt_->on_connected_change([this](bool connected) { modbus_->set_mqtt_connected(connected); });
    }
  }
  trace_ = make_trace();
  if (!model.gateway.control.empty()) {
    const Surveys surveys = [this](std::size_t bus) -> const canopen::BusSurvey& { return survey(bus); };
    control::Service service = control::plant_service(plant_, surveys, record_request(recording_.get()));
    service.open_stream = control::stream_source(plant_, *trace_, surveys);
    control_ = std::make_unique<control::Server>(
        executor, control::Place{model.gateway.control, control_group}, std::move(service),
        control::Server::Notices{.warning = [](const std::string& text) { spdlog::warn(text); },
                                 .info = [](const std::string& text) { spdlog::info(text); }});
  }
  if (model.http) {
    make_http(executor);
  }
  for (std::size_t i = 0; i < buses_.size(); ++i) {
    follow_bus(executor, i);
  }
}

Gateway::~Gateway() = default;

void Gateway::follow_bus(const boost::asio::any_io_executor& executor, std::size_t i) {
  BusInUse& in_use = buses_[i];
  in_use.state =
      in_use.bus->subscribe_state([this, i](const canopen::BusState& state) { plant_.set_bus_state(i, state); });
  in_use.timing = in_use.bus->subscribe_timing([bus = &plant_.model().buses[i]](const canopen::BitTiming& timing) {
    spdlog::info("{}: {}", bus->name, describe(timing));
    for (const std::string& doubt : doubts_about(timing, bus->bitrate)) {
      spdlog::warn("{}: {}", bus->name, doubt);
    }
  });
  in_use.watch = std::make_unique<canopen::BusWatch>(
      executor, *in_use.bus, plant_.model().buses[i].other_master,
      canopen::BusWatch::Handlers{.changed =
                                      [this, i, &in_use](const canopen::BusTroubles& troubles) {
                                        in_use.troubles = troubles;
                                        plant_.set_bus_troubles(i, troubles);
                                      },
                                  .remark = [name = plant_.model().buses[i].name](
                                                const std::string& text) { spdlog::info("{}: {}", name, text); }});
  for (const config::Drive& drive : plant_.model().drives) {
    if (drive.bus == i && drive.enabled) {
      in_use.watch->watch_commands_to(drive.node);
    }
  }
  in_use.survey = make_survey(executor, *in_use.bus, plant_, i, in_use.troubles);
}

void Gateway::make_http(const boost::asio::any_io_executor& executor) {
  plant_.add(tally_);
  live_ = std::make_unique<http::Live>(plant_);
  history_ = std::make_unique<http::History>(executor, plant_);
  plant_.add(*live_);
  site_ = std::make_unique<http::Site>(http_site());
  http_ = std::make_unique<http::Server>(
      executor, *plant_.model().http, [this](const http::Request& request) { return http::respond(request, *site_); },
      http::LiveSource{.begin = [this] { return live_->begin(); },
                       .take =
                           [this](http::Live::Place& place) {
                             return live_->take(place, [this] { return process::health_json(health()); });
                           }},
      net::Notices{.info = [](const std::string& text) { spdlog::info(text); },
                   .warning = [](const std::string& text) { spdlog::warn(text); }});
  site_->trace = trace_.get();
  site_->history = [this](std::size_t drive) { return history_->json(drive); };
  site_->http = [this] { return http_->figures(); };
  site_->survey = [this](std::size_t bus) -> const canopen::BusSurvey& { return survey(bus); };
}

http::Site Gateway::http_site() {
  http::Site site{.plant = plant_,
                  .commands = tally_,
                  .version = GATEWAY_VERSION,
                  .map = render_map_json(plant_.model()),
                  .health = [this] { return health(); }};
  if (modbus_) {
    site.modbus = [this] {
      return http::ModbusFigures{
          .clients = modbus_->clients(), .refused = modbus_->refused(), .counts = modbus_->counts()};
    };
  }
  if (mqtt_) {
    site.mqtt = [this] {
      const process::BrokerHealth broker = mqtt_->broker_health();
      return http::MqttFigures{.connected = mqtt_->connected(),
                               .counts = mqtt_->broker_counts(),
                               .put_right = broker.put_right,
                               .refused_subscriptions = broker.refused.size()};
    };
  }
  if (journal_) {
    site.journal = [this] {
      return http::JournalFigures{.lost = journal_->queue().lost(), .passed_by = journal_->queue().passed_by()};
    };
    site.journal_lines = [this]() -> const std::deque<std::string>& { return journal_->newest_lines(); };
  }
  if (recording_) {
    recording_->show_in(site);
  }
  return site;
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

std::vector<Gateway::BusInUse> Gateway::make_buses(const boost::asio::any_io_executor& executor,
                                                   const config::Model& model, const LinkFactory& make_link) {
  std::vector<BusInUse> buses;
  for (const config::Bus& bus : model.buses) {
    buses.push_back({std::make_unique<canopen::Bus>(executor, make_link(bus), settings_of(bus))});
  }
  return buses;
}

std::vector<process::Plant::BusPort> Gateway::ports(const std::vector<BusInUse>& buses) {
  std::vector<process::Plant::BusPort> ports;
  for (const BusInUse& in_use : buses) {
    ports.push_back({in_use.bus.get(), [bus = in_use.bus.get()] { return bus->statistics(); }});
  }
  return ports;
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
  if (modbus_) {
    modbus_->start(passed);
  } else {
    close_unused(passed);
  }
  if (mqtt_) {
    mqtt_->start();
  }
  if (control_) {
    control_->start();
  }
  if (http_) {
    http_->start();
    history_->start();
  }
  plant_.start();
  for (BusInUse& in_use : buses_) {
    in_use.bus->start();
    in_use.watch->start();
    in_use.survey->start();
  }
}

// No command begins any more; those that have begun still get their answer on MQTT and the control socket. Modbus
// clients are gone at once, and what they began ends with the plant.
boost::asio::awaitable<void> Gateway::stop() {
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
  for (BusInUse& in_use : buses_) {
    in_use.watch->stop();
    in_use.survey->stop();
    co_await in_use.bus->stop();
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
