#include "tests/unit/mqtt/plant_site.h"

#include <gtest/gtest.h>

#include <boost/asio/co_spawn.hpp>
#include <chrono>
#include <exception>
#include <utility>

#include "tests/support/change_plant.h"
#include "tests/support/spawn.h"

namespace mqtt::test {
namespace {

using std::chrono::milliseconds;

constexpr std::uint8_t kNode = 5;

void fill_dictionary(support::Puppet& puppet) {
  puppet.dictionary = {{{0x1017, 0}, {500, 2}}, {{0x1001, 0}, {0, 1}},      {{0x2021, 1}, {0, 2}},
                       {{0x2021, 2}, {0, 2}},   {{0x2021, 3}, {3, 1}},      {{0x2021, 4}, {0, 2}},
                       {{0x2000, 1}, {0, 2}},   {{0x2000, 2}, {0, 2}},      {{0x2031, 0}, {0, 1}},
                       {{0x2032, 0}, {1, 1}},   {{0x2002, 3}, {0x1234, 2}}, {{0x2030, 0}, {0, 4}}};
}

}  // namespace

config::Model PlantSite::bridge_model() {
  config::Model made = model();
  config::Drive& drive = made.drives[0];
  drive.node.error_control.policy = canopen::SetupPolicy::assume;
  drive.signals[kCounter].access = config::Access::write;
  drive.faults.has_error_field = false;
  return made;
}

PlantSite::PlantSite(config::Model model, const std::optional<alarms::Alarm>& emcy)
    : model_(std::move(model)),
      can_(loop_.executor()),
      puppet_(can_, kNode),
      bus_(loop_.executor(), can_.connect(), {.bitrate = 250000, .node_id = 127, .heartbeat = {}, .sync = {}}),
      plant_(loop_.executor(), model_, {{&bus_, [this] { return bus_.statistics(); }}}),
      broker_(new FakeBroker),
      bridge_(loop_.executor(), plant_, *model_.mqtt, model_.gateway, "1.2.3", "00112233aabbccdd",
              std::unique_ptr<Broker>(broker_),
              [this](Level, std::string text) { notices_.push_back(std::move(text)); }),
      values_{0, 0, 0, 0, 3, 0, 0} {
  fill_dictionary(puppet_);
  plant_.add(bridge_);
  bridge_.start();
  if (emcy) {
    plant_.drive(0).restore(alarms::AlarmKind::emcy, *emcy);
  }
  bus_.start();
  plant_.start();
  loop_.settle();
  plant_.set_bus_state(0, bus_.state());
  loop_.settle();
}

PlantSite::~PlantSite() {
  stop_bridge();
  const auto plant = support::spawn(loop_.executor(), plant_.stop());
  EXPECT_TRUE(loop_.advance_until([&plant] { return *plant; }, std::chrono::seconds(5)));
  const auto bus = support::spawn(loop_.executor(), bus_.stop());
  EXPECT_TRUE(loop_.advance_until([&bus] { return *bus; }, std::chrono::seconds(5)));
}

void PlantSite::stop_bridge() {
  if (bridge_stopped_) {
    return;
  }
  bridge_stopped_ = true;
  const auto done = support::spawn(loop_.executor(), bridge_.stop());
  EXPECT_TRUE(loop_.advance_until([&done] { return *done; }, std::chrono::seconds(5)));
}

void PlantSite::change(config::Model model) {
  support::change_plant(loop_, plant_, std::move(model), {{&bus_, [this] { return bus_.statistics(); }}});
  loop_.settle();
}

void PlantSite::bring_up_drive() {
  puppet_.boot_up();
  run_silent(milliseconds(300));
  const canopen::NodeStatus& status = plant_.drive(0).status();
  ASSERT_TRUE(status.online) << status.boot_text;
  ASSERT_EQ(status.nmt, canopen::NmtState::operational);
  run(milliseconds(1500));  // polled signals come too
}

void PlantSite::connect(ConnectionId connection) {
  broker_->events->on_connected({.id = connection});
  loop_.settle();
  broker_->answer_subscriptions();
  loop_.settle();
}

void PlantSite::send_values(std::uint16_t status, std::uint16_t frequency, std::uint8_t state,
                            std::uint16_t fault_code) {
  values_ = {static_cast<std::uint8_t>(status),
             static_cast<std::uint8_t>(status >> 8),
             static_cast<std::uint8_t>(frequency),
             static_cast<std::uint8_t>(frequency >> 8),
             state,
             static_cast<std::uint8_t>(fault_code),
             static_cast<std::uint8_t>(fault_code >> 8)};
  puppet_.tpdo(1, values_);
  loop_.settle();
}

void PlantSite::run(canopen::Duration time) {
  for (canopen::Duration passed{}; passed < time; passed += milliseconds(50)) {
    puppet_.heartbeat();
    puppet_.tpdo(1, values_);
    loop_.advance(milliseconds(50), milliseconds(10));
  }
}

void PlantSite::run_silent(canopen::Duration time) {
  for (canopen::Duration passed{}; passed < time; passed += milliseconds(50)) {
    puppet_.heartbeat();
    loop_.advance(milliseconds(50), milliseconds(10));
  }
}

void PlantSite::receive(Incoming message, canopen::Duration time) {
  message.received = canopen::Clock::now();
  broker_->events->on_message(std::move(message));
  loop_.settle();
  run(time);
}

void PlantSite::command(const std::string& topic, const std::string& payload) {
  receive({.topic = "canopen/line3/" + topic, .payload = payload});
}

std::string PlantSite::last_answer(const std::string& topic) const {
  const std::vector<std::string> answers = broker_->on(topic);
  return answers.empty() ? "none" : answers.back();
}

std::string PlantSite::retained(const std::string& topic) const {
  const auto found = broker_->retained.find("canopen/line3/" + topic);
  return found == broker_->retained.end() ? "never published" : found->second;
}

}  // namespace mqtt::test
