// What makes the bridges of a gateway, and shows them to HTTP.

#include <spdlog/spdlog.h>
#include <unistd.h>

#include <deque>
#include <string>
#include <utility>

#include "bridges/modbus/passed_sockets.h"
#include "bridges/mqtt/publisher.h"
#include "bridges/trace/feed.h"
#include "canopen/survey/bus_survey.h"
#include "daemon/control/plant_service.h"
#include "daemon/control/streams.h"
#include "daemon/gateway.h"
#include "daemon/http/respond.h"
#include "daemon/log.h"
#include "daemon/map.h"
#include "daemon/program_health.h"
#include "daemon/recording.h"

namespace gateway {
namespace {

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

net::Notices log_connections() {
  return {.info = [](const std::string& text) { spdlog::info(text); },
          .warning = [](const std::string& text) { spdlog::warn(text); }};
}

void close_unused(std::span<const int> passed) {
  if (!passed.empty()) {
    spdlog::warn("the service manager passed sockets, but there is no [modbus], so they are closed");
  }
  for (const int descriptor : passed) {
    modbus::stop_listening(descriptor);
    ::close(descriptor);
  }
}

}  // namespace

void Gateway::make_recorder() {
  if (!plant_.model().gateway.state_dir.empty()) {
    recording_ = make_recording(executor_, plant_, ports());
  }
}

void Gateway::make_modbus() {
  modbus_model_ = plant_.shared_model();
  if (!modbus_model_->modbus) {
    return;
  }
  modbus_ = std::make_unique<modbus::Server>(executor_, plant_, *modbus_model_->modbus, log_connections());
  modbus_->count_lost_messages_by(&Log::dropped);
  plant_.add(*modbus_);
}

void Gateway::start_modbus(std::span<const int> passed) {
  if (modbus_) {
    modbus_->start(passed);
  } else {
    close_unused(passed);
  }
}

void Gateway::make_mqtt() {
  mqtt_model_ = plant_.shared_model();
  if (!mqtt_model_->mqtt) {
    return;
  }
  const config::Mqtt& settings = *mqtt_model_->mqtt;
  const config::Gateway& gateway = mqtt_model_->gateway;
  mqtt_ = std::make_unique<mqtt::Bridge>(
      executor_, plant_, settings, gateway, GATEWAY_VERSION, instance_,
      std::make_unique<mqtt::Publisher>(executor_, mqtt::publisher_settings(settings, gateway), log_notice),
      log_notice);
  plant_.add(*mqtt_);
  mqtt_->tell_program_health_by(
      [this] { return program_health(started_, journal_ ? journal_->newest_hash() : std::string()); });
  mqtt_->on_connected_change([this](bool connected) {
    if (modbus_) {
      modbus_->set_mqtt_connected(connected);
    }
  });
}

void Gateway::make_control(const std::string& group) {
  const Surveys surveys = [this](std::size_t bus) -> const canopen::BusSurvey& { return survey(bus); };
  control::RecordRequest record = [this](std::size_t bus, const std::string& drive,
                                         const std::string& user) -> canopen::Result<recorder::Recorder::Requested> {
    if (!recording_) {
      return control::nothing_recorded();
    }
    return recording_->recorder().request(bus, drive, user);
  };
  control::Service service = control::plant_service(plant_, surveys, std::move(record));
  service.open_stream = control::stream_source(plant_, *trace_, surveys);
  control_ = std::make_unique<control::Server>(
      executor_, control::Place{plant_.model().gateway.control, group}, std::move(service),
      control::Server::Notices{.warning = [](const std::string& text) { spdlog::warn(text); },
                               .info = [](const std::string& text) { spdlog::info(text); }});
}

void Gateway::make_http() {
  http_model_ = plant_.shared_model();
  if (!http_model_->http) {
    return;
  }
  if (!site_) {  // A reload that changes [http] alone keeps what is shown.
    tally_ = std::make_unique<http::CommandTally>();
    plant_.add(*tally_);
    live_ = std::make_unique<http::Live>(plant_);
    plant_.add(*live_);
    history_ = std::make_unique<http::History>(executor_, plant_);
    plant_.add(*history_);
    site_ = std::make_unique<http::Site>(
        http::Site{.plant = plant_, .commands = *tally_, .version = GATEWAY_VERSION, .map = nullptr, .health = [this] {
                     return health();
                   }});
  }
  http_ = std::make_unique<http::Server>(
      executor_, *http_model_->http, [this](const http::Request& request) { return http::respond(request, *site_); },
      http::LiveSource{.begin = [this] { return live_->begin(); },
                       .take =
                           [this](http::Live::Place& place) {
                             return live_->take(place, [this] { return process::health_json(health()); });
                           }},
      log_connections());
  fill_site();
}

void Gateway::start_http() {
  if (http_) {
    http_->start();
    history_->start();
  }
}

void Gateway::fill_site() {
  if (!site_) {
    return;
  }
  http::Site& site = *site_;
  site.map = std::make_shared<const std::string>(render_map_json(plant_.model()));
  site.trace = trace_.get();
  site.history = [this](std::size_t drive) { return history_->json(drive); };
  site.http = [this] { return http_ ? http_->figures() : http::HttpFigures{}; };
  site.survey = [this](std::size_t bus) -> const canopen::BusSurvey& { return survey(bus); };
  site.modbus = {};
  site.mqtt = {};
  site.records = {};
  site.recorder = {};
  site.read_record = {};
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
    Recording* const recording = recording_.get();
    site.records = [recording]() -> const std::optional<recorder::StoredRecords>& {
      return recording->recorder().keeper().records();
    };
    site.recorder = [recording] {
      const recorder::RecordKeeper& keeper = recording->recorder().keeper();
      return http::RecorderFigures{.works = keeper.works(), .lost = keeper.lost()};
    };
    site.read_record = [recording](std::string name, std::uint64_t offset) {
      return recording->read(std::move(name), offset);
    };
  }
}

}  // namespace gateway
