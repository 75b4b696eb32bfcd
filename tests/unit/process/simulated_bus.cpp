#include "tests/unit/process/simulated_bus.h"

#include <algorithm>
#include <stdexcept>

#include "config/load.h"
#include "tests/support/recording_link.h"

namespace process {

using namespace std::chrono_literals;

void Neighbour::on_frames(std::span<const canopen::Received> frames) {
  for (const canopen::Received& received : frames) {
    frames_.push_back(received.frame);
  }
}

std::size_t Neighbour::heard(std::uint32_t id) const {
  return static_cast<std::size_t>(
      std::ranges::count_if(frames_, [id](const canopen::Frame& frame) { return frame.id == id; }));
}

std::size_t Neighbour::downloads(std::uint8_t node) const {
  return static_cast<std::size_t>(std::ranges::count_if(frames_, [node](const canopen::Frame& frame) {
    return frame.id == 0x600U + node && (frame.data[0] & 0xE0U) == 0x20;
  }));
}

SimulatedBus::~SimulatedBus() {
  if (plant_) {
    watch_->stop();
    const auto stopped = support::spawn(loop_.executor(), plant_->stop());
    loop_.settle();
    EXPECT_TRUE(*stopped);
    bus_state_ = {};
    watch_.reset();
    plant_.reset();
    const auto bus_stopped = support::spawn(loop_.executor(), bus_->stop());
    loop_.settle();
    EXPECT_TRUE(*bus_stopped);
  }
}

void SimulatedBus::load(const std::string& drives, const std::string& bus) {
  config::Loaded loaded = config::load_text(
      "[modbus]\n[[bus]]\nname = \"can0\"\ninterface = \"virtual\"\n" + bus + drives,
      {.file = "site.toml", .profile_dirs = {GATEWAY_SOURCE_DIR "/config/profiles"}, .host_name = "host"});
  if (!loaded.model) {
    throw std::invalid_argument("the site does not load: " + config::to_string(loaded.findings.front()));
  }
  model_ = *std::move(loaded.model);
}

simulator::Drive& SimulatedBus::add(std::string_view kind, std::uint8_t node, const simulator::DriveOptions& options) {
  simulator::Network& network =
      *networks_.emplace_back(std::make_unique<simulator::Network>(loop_.executor(), wire_.connect()));
  network.open();
  return *drives_.emplace_back(simulator::make_drive(kind, node, network, options));
}

void SimulatedBus::start() {
  const config::Bus& keys = model_.buses[0];
  canopen::BusSettings settings;
  settings.node_id = keys.node_id;
  settings.heartbeat = keys.heartbeat;
  settings.sync = keys.sync;
  bus_ = std::make_unique<canopen::Bus>(loop_.executor(),
                                        std::make_unique<support::RecordingLink>(wire_.connect(), sent_), settings);
  plant_ = std::make_unique<Plant>(loop_.executor(), model_, std::vector<Plant::BusPort>{{bus_.get(), {}}});
  bus_state_ = bus_->subscribe_state([this](const canopen::BusState& state) { plant_->set_bus_state(0, state); });
  watch_ = std::make_unique<canopen::BusWatch>(
      loop_.executor(), *bus_, keys.other_master,
      canopen::BusWatch::Handlers{
          .changed = [this](const canopen::BusTroubles& troubles) { plant_->set_bus_troubles(0, troubles); },
          .remark = [this](const std::string& text) { bus_remarks_.push_back(text); }});
  for (const config::Drive& each : model_.drives) {
    watch_->watch_commands_to(each.node);
  }
  bus_->start();
  watch_->start();
  plant_->start();
  loop_.settle();
}

Outcome SimulatedBus::finish(const support::Spawned<Outcome>& under_way) {
  EXPECT_TRUE(loop_.advance_until([&] { return under_way.done(); }, 2s));
  return under_way.done() ? under_way.get() : Outcome(canopen::Error{});
}

Outcome SimulatedBus::write(const std::vector<std::pair<std::string, canopen::Raw>>& fields, std::size_t drive) {
  Drive& written = plant_->drive(drive);
  std::vector<FieldWrite> writes;
  for (const auto& [name, raw] : fields) {
    writes.push_back({static_cast<SignalId>(written.model().find(name).value()), raw});
  }
  return finish(support::spawn(loop_.executor(), written.write(origin(), std::move(writes))));
}

Outcome SimulatedBus::stop_motor() {
  return finish(support::spawn(loop_.executor(), drive().stop_motor(origin())));
}

Outcome SimulatedBus::nmt(canopen::NmtCommand command) {
  return finish(support::spawn(loop_.executor(), drive().nmt(origin(), command)));
}

}  // namespace process
