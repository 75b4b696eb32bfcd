#include "daemon/bus_in_use.h"

#include <spdlog/spdlog.h>

#include <utility>

#include "canopen/survey/bus_survey.h"

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

}  // namespace

BusInUse::BusInUse(const boost::asio::any_io_executor& executor, const config::Bus& settings,
                   std::unique_ptr<canopen::Link> link)
    : executor_(executor), name_(settings.name), bus_(executor, std::move(link), settings_of(settings)) {}

BusInUse::~BusInUse() = default;

void BusInUse::follow(process::Plant& plant, std::size_t position) {
  known_.index = position;
  const config::Bus& settings = plant.model().buses[position];
  state_ = bus_.subscribe_state(
      [this, &plant](const canopen::BusState& state) { plant.set_bus_state(known_.index, state); });
  timing_ = bus_.subscribe_timing([name = name_, bitrate = settings.bitrate](const canopen::BitTiming& timing) {
    spdlog::info("{}: {}", name, describe(timing));
    for (const std::string& doubt : doubts_about(timing, bitrate)) {
      spdlog::warn("{}: {}", name, doubt);
    }
  });
  watch_ = std::make_unique<canopen::BusWatch>(
      executor_, bus_, settings.other_master,
      canopen::BusWatch::Handlers{
          .changed =
              [this, &plant](const canopen::BusTroubles& troubles) {
                known_.troubles = troubles;
                plant.set_bus_troubles(known_.index, troubles);
              },
          .remark = [name = name_](const std::string& text) { spdlog::info("{}: {}", name, text); }});
  watch_commands(plant);
  survey_ = make_survey(executor_, bus_, plant, known_);
}

void BusInUse::move(const process::Plant& plant, std::size_t position) {
  known_.index = position;
  watch_->forget_commands();
  watch_commands(plant);
  set_timeouts(*survey_, plant, position);
}

void BusInUse::watch_commands(const process::Plant& plant) {
  for (const config::Drive& drive : plant.model().drives) {
    if (drive.bus == known_.index && drive.enabled) {
      watch_->watch_commands_to(drive.node);
    }
  }
}

void BusInUse::start() {
  bus_.start();
  watch_->start();
  survey_->start();
}

boost::asio::awaitable<void> BusInUse::stop() {
  watch_->stop();
  survey_->stop();
  co_await bus_.stop();
}

process::Plant::BusPort BusInUse::port() {
  return {&bus_, [this] { return bus_.statistics(); }};
}

}  // namespace gateway
