// The bridge on a real broker: topics of alarms and statuses that somebody else overwrites or empties.

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <string>

#include "bridges/mqtt/bridge.h"
#include "canopen/bus/bus.h"
#include "canopen/bus/virtual_link.h"
#include "tests/support/mosquitto.h"
#include "tests/unit/mqtt/publisher_fixture.h"
#include "tests/unit/mqtt/site.h"

namespace mqtt {
namespace {

using namespace std::chrono_literals;

/// A drive out of service, of which all is known at once, so that nothing changes by itself.
config::Model quiet_model() {
  config::Model model = test::model();
  model.drives[0].enabled = false;
  return model;
}

class PutRight : public test::PublisherFixture {
 protected:
  void SetUp() override {
    ASSERT_TRUE(broker_.start()) << "is mosquitto installed?";
    make_bridge();
    plant_.set_bus_state(0, {canopen::BusCondition::error_active, 0, 0});
    ASSERT_TRUE(run_until([this] { return bridge_->connected(); }));
    ASSERT_TRUE(subscribe_witness());
  }

  void make_bridge() {
    auto publisher_of_bridge = std::make_unique<Publisher>(
        context.get_executor(), settings(broker_.port()), [this](Level, std::string text) { notices.push_back(text); });
    bridge_ = std::make_unique<Bridge>(context.get_executor(), plant_, *model_.mqtt, model_.gateway, "1.2.3",
                                       "00112233aabbccdd", std::move(publisher_of_bridge),
                                       [this](Level, std::string text) { notices.push_back(text); });
    plant_.add(*bridge_);
    bridge_->start();
  }

  // The witness is a publisher too: it sees and writes as any other client does.
  bool subscribe_witness() {
    PublisherSettings made = settings(broker_.port());
    made.client.client_id = "witness";
    made.client.will_topic = "witness";
    make(std::move(made));
    if (!connected() ||
        !subscribe({{"canopen/line3/bus/+/alarm", 1}, {"canopen/line3/alarms", 1}, {"canopen/line3/+/alarm/+", 1}})) {
      return false;
    }
    publisher->open(connections.back());
    return run_until([this] { return messages.size() == kTopics && last("canopen/line3/alarms") == "[]"; });
  }

  [[nodiscard]] std::optional<std::string> last(const std::string& topic) const {
    for (auto message = messages.rbegin(); message != messages.rend(); ++message) {
      if (message->topic == topic) {
        return message->payload;
      }
    }
    return std::nullopt;
  }
  [[nodiscard]] std::size_t heard(const std::string& topic) const {
    return static_cast<std::size_t>(std::count_if(
        messages.begin(), messages.end(), [&topic](const Incoming& message) { return message.topic == topic; }));
  }
  void run_for(std::chrono::milliseconds time) {
    const auto end = Clock::now() + time;
    EXPECT_TRUE(run_until([end] { return Clock::now() >= end; }));
  }

  void TearDown() override {
    const auto done = support::spawn(context.get_executor(), bridge_->stop());
    EXPECT_TRUE(run_until([&done] { return *done; }));
    bridge_.reset();
    PublisherFixture::TearDown();
  }

  static constexpr std::size_t kTopics = alarms::kAlarmKinds.size() + 2;  ///< Of the drive, the bus, and the list.
  static constexpr const char* kStatus = "canopen/line3/status";
  static constexpr const char* kPumpStatus = "canopen/line3/pump1/status";
  static constexpr const char* kBus = "canopen/line3/bus/can0/alarm";
  static constexpr const char* kEmcy = "canopen/line3/pump1/alarm/emcy";

  support::Mosquitto broker_;
  config::Model model_ = quiet_model();
  canopen::VirtualBus can_{context.get_executor()};
  canopen::Bus bus_{
      context.get_executor(), can_.connect(), {.bitrate = 250000, .node_id = 127, .heartbeat = {}, .sync = {}}};
  process::Plant plant_{context.get_executor(), model_, {{&bus_, [this] { return bus_.statistics(); }}}};
  std::unique_ptr<Bridge> bridge_;
};

TEST_F(PutRight, WhatSomebodyOverwritesOrEmpties) {
  for (const std::string topic : {kBus, kEmcy, "canopen/line3/alarms"}) {
    const std::string word = last(topic).value_or("");
    ASSERT_FALSE(word.empty()) << topic;
    for (const char* written : {"{\"active\":true}", ""}) {
      const std::size_t before = heard(topic);
      publisher->publish({{.topic = topic, .payload = written}});
      EXPECT_TRUE(run_until([&] { return heard(topic) >= before + 2; })) << topic;
      EXPECT_EQ(last(topic), word);
      run_for(200ms);
      EXPECT_EQ(heard(topic), before + 2) << "what was written, and ours once";
      run_for(900ms);
    }
  }
}

// A late will of an older connection says the same as a stranger.
TEST_F(PutRight, AStatusThatSomebodyOverwrites) {
  ASSERT_TRUE(subscribe({{"canopen/line3/status", 1}, {"canopen/line3/pump1/status", 1}}));
  ASSERT_TRUE(run_until([this] { return heard(kStatus) == 1 && heard(kPumpStatus) == 1; }));
  for (const std::string topic : {kStatus, kPumpStatus}) {
    const std::string word = last(topic).value_or("");
    EXPECT_EQ(word, topic == kStatus ? "online" : "offline") << "the drive is out of service";
    for (const char* written : {"away", ""}) {
      const std::size_t before = heard(topic);
      publisher->publish({{.topic = topic, .payload = written}});
      EXPECT_TRUE(run_until([&] { return heard(topic) >= before + 2; })) << topic;
      EXPECT_EQ(last(topic), word);
      run_for(1200ms);
      EXPECT_EQ(heard(topic), before + 2) << "what was written, and ours once";
    }
  }
}

TEST_F(PutRight, NothingIsSaidThatNobodyTouched) {
  const std::size_t before = messages.size();
  publisher->publish({{.topic = "canopen/line3/gone/alarm/emcy", .payload = "{}"}});
  EXPECT_TRUE(run_until([this] { return heard("canopen/line3/gone/alarm/emcy") == 1; }));
  run_for(1500ms);
  EXPECT_EQ(messages.size(), before + 1);
}

}  // namespace
}  // namespace mqtt
