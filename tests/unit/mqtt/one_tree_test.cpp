// The gateway's tree at the broker: what is left there of before, and who else is there.

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "bridges/mqtt/bridge.h"
#include "tests/unit/mqtt/plant_site.h"

namespace mqtt {
namespace {

using namespace std::chrono_literals;
using test::contains;
using test::PlantSite;

constexpr const char* kBroker = "10.0.0.1:1883";
constexpr const char* kOld = "canopen/line3/pump1/old_signal";

/// The first connection, with what the broker keeps.
void look(PlantSite& site, const std::vector<std::pair<std::string, std::string>>& kept) {
  site.broker().events->on_connected({.id = 1, .broker = kBroker});
  site.loop().settle();
  site.broker().unanswered.clear();
  site.broker().events->on_subscribed({.filter = "canopen/line3/#"});
  for (const auto& [topic, payload] : kept) {
    site.receive({.topic = "canopen/line3/" + topic, .payload = payload, .retained = true});
  }
  site.run(2 * Session::kQuiet + 100ms);
  site.broker().answer_subscriptions();
  site.loop().settle();
}

TEST(MqttOneTree, WhatNobodyPublishesAnyMoreIsEmptiedBehindOnline) {
  PlantSite site;
  site.bring_up_drive();
  look(site, {{"status", "offline"}, {"pump1/old_signal", "1"}, {"pump1/status", "online"}, {"app", "x"}});
  ASSERT_TRUE(site.bridge().connected());
  site.run(100ms);
  EXPECT_EQ(site.broker().newest(kOld), Message{.topic = kOld});
  bool online = false;
  for (const Message& message : site.broker().published) {
    online = online || (message.topic == "canopen/line3/status" && message.payload == "online");
    EXPECT_TRUE(online || message.topic != kOld);
    EXPECT_NE(message.topic, "canopen/line3/app");
  }
  EXPECT_EQ(site.retained("pump1/status"), "online");
  ASSERT_EQ(site.notices().size(), 1U);
  EXPECT_TRUE(contains(site.notices()[0], kOld)) << site.notices()[0];
}

TEST(MqttOneTree, BehindALifeThatEndedWithoutAWordItIsEmptiedWhenNobodyElseIsHeard) {
  PlantSite site;
  site.bring_up_drive();
  look(site, {{"status", "online"}, {"pump1/old_signal", "1"}});
  site.run(64s);
  EXPECT_TRUE(site.broker().on(kOld).empty());
  site.run(2s);
  EXPECT_EQ(site.broker().on(kOld), std::vector<std::string>{""});
}

TEST(MqttOneTree, ACommandThatComesByTheLookIsLeftToItsSubscription) {
  PlantSite site;
  site.bring_up_drive();
  look(site, {{"pump1/frequency_command/set", "10"}});
  site.run(1s);
  EXPECT_TRUE(site.broker().on("canopen/line3/result").empty());
  EXPECT_TRUE(site.broker().on("canopen/line3/pump1/frequency_command/set").empty());
  EXPECT_TRUE(site.puppet().written.empty());
  site.receive({.topic = "canopen/line3/pump1/frequency_command/set", .payload = "10", .retained = true}, 100ms);
  EXPECT_TRUE(contains(site.last_answer(), R"("code":"retained")")) << site.last_answer();
  EXPECT_EQ(site.broker().on("canopen/line3/pump1/frequency_command/set"), std::vector<std::string>{""});
  EXPECT_TRUE(site.puppet().written.empty());
}

}  // namespace
}  // namespace mqtt
