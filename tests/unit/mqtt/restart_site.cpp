#include "tests/unit/mqtt/restart_site.h"

#include <gtest/gtest.h>

#include <chrono>
#include <stdexcept>
#include <utility>

#include "config/load.h"
#include "tests/support/spawn.h"

namespace mqtt::test {
namespace {

using namespace std::chrono_literals;

constexpr std::uint8_t kDriveNode = 5;
constexpr std::uint8_t kGatewayNode = 127;
constexpr canopen::Duration kMoved = 5ms;

config::Model model_of(const std::string& profile) {
  const std::string site =
      "[gateway]\nname = \"line3\"\n[[bus]]\nname = \"can0\"\ninterface = \"virtual\"\n[mqtt]\n[[drive]]\n"
      "name = \"pump1\"\nnode = 5\nprofile = \"" +
      profile + "\"\n";
  config::Loaded loaded = config::load_text(
      site, {.file = "site.toml", .profile_dirs = {GATEWAY_SOURCE_DIR "/config/profiles"}, .host_name = "host"});
  if (!loaded.model) {
    throw std::invalid_argument("the site does not load: " + config::to_string(loaded.findings.front()));
  }
  return *std::move(loaded.model);
}

}  // namespace

RestartSite::Gateway::Gateway(support::HandDrivenLoop& loop, canopen::VirtualBus& wire, const config::Model& model,
                              std::map<std::string, std::string>& retained)
    : bus(loop.executor(), wire.connect(), {.bitrate = 250000, .node_id = kGatewayNode, .heartbeat = {}, .sync = {}}),
      plant(loop.executor(), model, {{&bus, [this] { return bus.statistics(); }}}),
      bus_state(bus.subscribe_state([this](const canopen::BusState& state) { plant.set_bus_state(0, state); })),
      broker(new FakeBroker),
      bridge(loop.executor(), plant, *model.mqtt, model.gateway, "1.2.3", "00112233aabbccdd",
             std::unique_ptr<Broker>(broker), [](Level, const std::string&) {}) {
  broker->retained = retained;
}

RestartSite::RestartSite(const std::string& profile, bool remembers)
    : model_(model_of(profile)), remembers_(remembers), drive_(nullptr) {
  network_.open();
  drive_ = simulator::make_drive(profile, kDriveNode, network_);
  drive_->power_on();
  start_gateway();
  run(5s);
}

RestartSite::~RestartSite() {
  if (gateway_) {
    kill_gateway();
  }
}

void RestartSite::kill_gateway() {
  retained_ = gateway_->broker->retained;
  if (remembers_) {
    memory_.emplace();
    for (const alarms::AlarmKind kind : alarms::kAlarmKinds) {
      memory_->at(static_cast<std::size_t>(kind)) = gateway_->plant.drive(0).alarm(kind);
    }
  }
  const auto ended = support::spawn(loop_.executor(), [](Gateway& gateway) -> boost::asio::awaitable<void> {
    co_await gateway.bridge.stop();
    co_await gateway.plant.stop();
    co_await gateway.bus.stop();
  }(*gateway_));
  EXPECT_TRUE(loop_.advance_until([&ended] { return *ended; }, 5s));
  gateway_.reset();
  if (broker_up_) {
    retained_["canopen/line3/status"] = "offline";  // The will.
  }
}

void RestartSite::start_gateway() {
  gateway_ = std::make_unique<Gateway>(loop_, wire_, model_, retained_);
  if (memory_) {
    for (const alarms::AlarmKind kind : alarms::kAlarmKinds) {
      gateway_->plant.drive(0).restore(kind, memory_->at(static_cast<std::size_t>(kind)));
    }
  }
  gateway_->plant.add(gateway_->bridge);
  gateway_->bridge.start();
  gateway_->bus.start();
  gateway_->plant.start();
  loop_.settle();
  if (broker_up_) {
    connect();
  }
}

void RestartSite::stop_broker() {
  broker_up_ = false;
  if (gateway_) {
    gateway_->broker->events->on_disconnected("gone");
    gateway_->broker->retained["canopen/line3/status"] = "offline";
  }
}

void RestartSite::start_broker() {
  broker_up_ = true;
  if (gateway_) {
    connect();
  }
}

// What is retained of the alarms comes with the subscription, as from any broker.
void RestartSite::connect() {
  BrokerEvents& events = *gateway_->broker->events;
  const std::map<std::string, std::string> held = gateway_->broker->retained;
  events.on_connected({.id = ++connections_});
  loop_.settle();
  gateway_->broker->answer_subscriptions();
  for (const auto& [topic, payload] : held) {
    if (topic.find("/alarm") != std::string::npos) {
      events.on_message({.topic = topic, .payload = payload, .retained = true, .received = canopen::Clock::now()});
    }
  }
  loop_.settle();
}

void RestartSite::set_fault(std::optional<std::uint16_t> code) {
  fault_ = code;
  to_give_ = true;
  give_fault();
}

void RestartSite::give_fault() {
  if (drive_->state() == simulator::NmtState::off || drive_->state() == simulator::NmtState::initialising) {
    to_give_ = true;  // Its errors are forgotten with its power.
    return;
  }
  if (std::exchange(to_give_, false)) {
    drive_->clear_faults();
    if (fault_) {
      drive_->fault(*fault_);
    }
  }
}

void RestartSite::run(canopen::Duration time) {
  for (canopen::Duration passed{}; passed < time; passed += kMoved) {
    loop_.advance(kMoved, kMoved);
    give_fault();
  }
}

std::string RestartSite::retained(const std::string& topic) const {
  const std::map<std::string, std::string>& held = gateway_ ? gateway_->broker->retained : retained_;
  const auto found = held.find("canopen/line3/" + topic);
  return found == held.end() ? "" : found->second;
}

}  // namespace mqtt::test
