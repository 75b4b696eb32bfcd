// The gateway's tree at the broker: what is left there of before, and who else is there.

#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "bridges/mqtt/bridge.h"
#include "tests/unit/mqtt/plant_site.h"

namespace mqtt {
namespace {

using namespace std::chrono_literals;
using test::contains;
using test::PlantSite;

constexpr const char* kBroker = "10.0.0.1:1883";
constexpr const char* kHealthTopic = "canopen/line3/health";
constexpr const char* kOthersHealth = R"({"ts":"2026-01-02T03:04:05.678Z","instance":"ffff222233334444"})";
constexpr const char* kLaterHealth = R"({"ts":"2026-01-02T03:05:05.678Z","instance":"ffff222233334444"})";
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
  site.run(Session::kQuiet + 100ms);
  EXPECT_EQ(site.broker().unsubscribed, std::vector<std::string>{"canopen/line3/#"});
  site.broker().events->on_unsubscribed("canopen/line3/#");
  site.loop().settle();
  site.broker().answer_subscriptions();
  site.loop().settle();
}

void connect_again(PlantSite& site) {
  site.broker().events->on_connected({.id = 2, .broker = kBroker});
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

TEST(MqttOneTree, WhereAnotherGatewayIsHeardMeanwhileNothingIsEmptied) {
  PlantSite site;
  site.bring_up_drive();
  look(site, {{"status", "online"}, {"pump1/old_signal", "1"}});
  site.run(10s);
  site.receive({.topic = kHealthTopic, .payload = kOthersHealth}, 100s);
  EXPECT_TRUE(site.broker().on(kOld).empty());
}

TEST(MqttOneTree, AnotherGatewayIsToldOnHealthAndByAnAlarmOfEachBusUntilItIsGone) {
  PlantSite site;
  site.bring_up_drive();
  look(site, {});
  site.run(1s);
  EXPECT_TRUE(contains(site.retained("info"), R"("instance":"00112233aabbccdd")")) << site.retained("info");
  EXPECT_TRUE(contains(site.retained("health"), R"("instance":"00112233aabbccdd")")) << site.retained("health");
  EXPECT_TRUE(contains(site.retained("health"), R"("another_instance":null)")) << site.retained("health");
  site.receive({.topic = kHealthTopic, .payload = site.retained("health")}, 1s);
  EXPECT_TRUE(contains(site.retained("bus/can0/alarm"), R"("active":false)")) << "our own, with MQTT 3.1.1";
  site.receive({.topic = kHealthTopic, .payload = kOthersHealth}, 1s);
  EXPECT_TRUE(contains(site.retained("health"), R"("another_instance":"ffff222233334444")")) << site.retained("health");
  const std::string alarm = site.retained("bus/can0/alarm");
  EXPECT_TRUE(contains(alarm, R"("active":true)")) << alarm;
  EXPECT_TRUE(contains(alarm, R"("reason":"other-gateway")")) << alarm;
  EXPECT_TRUE(contains(alarm, R"("severity":"warning")")) << alarm;
  EXPECT_TRUE(contains(site.retained("alarms"), R"("bus":"can0")")) << site.retained("alarms");
  site.run(180s);
  EXPECT_TRUE(contains(site.retained("bus/can0/alarm"), R"("active":false)")) << site.retained("bus/can0/alarm");
  EXPECT_TRUE(contains(site.retained("health"), R"("another_instance":null)")) << site.retained("health");
}

TEST(MqttOneTree, ATakeOverOfTheClientIdIsToldInTheSameWay) {
  PlantSite site;
  site.bring_up_drive();
  look(site, {});
  site.broker().events->on_taken_over();
  site.broker().events->on_disconnected("Session taken over (0x8E)");
  site.run(1s);
  connect_again(site);
  site.run(1s);
  EXPECT_TRUE(contains(site.retained("health"), R"("another_instance":"unknown")")) << site.retained("health");
  EXPECT_TRUE(contains(site.retained("bus/can0/alarm"), R"("reason":"other-gateway")"));
  EXPECT_EQ(site.broker().suspected, 0U) << "the broker said so itself";
}

TEST(MqttOneTree, WhoPublishedWhileWeWereAwayMayHaveTakenUsOver) {
  PlantSite site;
  site.bring_up_drive();
  look(site, {});
  site.receive({.topic = kHealthTopic, .payload = kOthersHealth, .retained = true});
  EXPECT_TRUE(contains(site.retained("bus/can0/alarm"), R"("active":false)")) << "perhaps our last life";
  site.broker().events->on_disconnected("gone");
  connect_again(site);
  site.receive({.topic = kHealthTopic, .payload = kLaterHealth, .retained = true}, 1s);
  EXPECT_EQ(site.broker().suspected, 2U);
  EXPECT_TRUE(contains(site.retained("bus/can0/alarm"), R"("reason":"other-gateway")"));
}

TEST(MqttOneTree, WhatIsPutRightIsCountedAndSaidOnceAMinute) {
  PlantSite site;
  site.bring_up_drive();
  look(site, {});
  site.run(1s);
  for (int i = 0; i < 5; ++i) {
    site.receive({.topic = "canopen/line3/pump1/status", .payload = "offline"}, 1s);
    site.receive({.topic = "canopen/line3/alarms", .payload = "x"}, 1s);
  }
  site.run(1s);
  EXPECT_TRUE(contains(site.retained("health"), R"("put_right":10)")) << site.retained("health");
  ASSERT_EQ(site.notices().size(), 1U);
  EXPECT_TRUE(contains(site.notices()[0], "canopen/line3/pump1/status")) << site.notices()[0];
  site.run(60s);
  site.receive({.topic = "canopen/line3/alarms", .payload = "x"}, 1s);
  ASSERT_EQ(site.notices().size(), 2U);
  EXPECT_TRUE(contains(site.notices()[1], "11 times")) << site.notices()[1];
}

TEST(MqttOneTree, AStopThatComesByTheLookIsCarriedOut) {
  PlantSite site;
  site.bring_up_drive();
  site.broker().events->on_connected({.id = 1, .broker = kBroker});
  site.loop().settle();
  site.broker().events->on_subscribed({.filter = "canopen/line3/#"});
  site.receive({.topic = "canopen/line3/stop", .payload = "1", .retained = true}, 100ms);
  site.receive({.topic = "canopen/line3/pump1/frequency_command/set", .payload = "10"}, 100ms);
  EXPECT_TRUE(site.broker().on("canopen/line3/result").empty()) << "one of the past, and one that is no stop";
  site.receive({.topic = "canopen/line3/stop", .payload = "1"}, 100ms);
  EXPECT_TRUE(contains(site.last_answer(), R"("topic":"canopen/line3/stop")")) << site.last_answer();
  site.run(Session::kQuiet);  // the look is being given back
  site.receive({.topic = "canopen/line3/stop", .payload = R"({"id":"s2"})"}, 100ms);
  EXPECT_TRUE(contains(site.last_answer(), R"("id":"s2")")) << site.last_answer();
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
