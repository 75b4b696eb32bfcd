// The bridge between several brokers: how one is left, and what is known of each.

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "bridges/mqtt/bridge.h"
#include "tests/unit/mqtt/plant_site.h"

namespace mqtt {
namespace {

using namespace std::chrono_literals;
using test::contains;
using test::PlantSite;

constexpr const char* kStatusLeft = "canopen/line3/status";
constexpr const char* kOldSignal = "canopen/line3/pump1/old_signal";
constexpr const char* kSet = "pump1/frequency_command/set";
constexpr const char* kSame = R"({"value":30.0,"id":"a1"})";

void connect_to_place(PlantSite& site, ConnectionId id, const std::string& broker, const std::string& address = {}) {
  site.broker().events->on_connected({.id = id, .broker = broker, .address = address});
  site.loop().settle();
}

/// Goes through the look, with what the broker keeps.
void be_shown(PlantSite& site, const std::string& topic, const std::string& status = "offline") {
  site.broker().unanswered.clear();
  site.broker().events->on_subscribed({.filter = "canopen/line3/#"});
  site.receive({.topic = kStatusLeft, .payload = status, .retained = true});
  site.receive({.topic = topic, .payload = "1", .retained = true});
  site.run(Session::kQuiet + 100ms);
  site.broker().events->on_unsubscribed("canopen/line3/#");
  site.loop().settle();
  site.broker().answer_subscriptions();
  site.loop().settle();
}

TEST(Leaving, SaysAllThatAnOrderlyEndSaysAndThenNothing) {
  PlantSite site;
  site.bring_up_drive();
  site.connect();
  site.send_values(1, 3000, 4);
  site.run(1s);
  site.broker().forget();
  site.broker().events->on_may_leave(1, true);
  site.loop().settle();
  ASSERT_EQ(site.broker().left, 1U);
  const std::vector<Message>& last = site.broker().last_words;
  ASSERT_FALSE(last.empty());
  EXPECT_EQ(last.back().topic, kStatusLeft);
  EXPECT_EQ(last.back().payload, "offline");
  EXPECT_TRUE(last.back().after_all);
  const auto state = std::ranges::find(last, "canopen/line3/pump1/state", &Message::topic);
  ASSERT_NE(state, last.end());
  EXPECT_TRUE(contains(state->payload, "\"online\":false")) << state->payload;
  EXPECT_FALSE(site.bridge().connected());
  site.broker().forget();
  site.run(5s);
  EXPECT_TRUE(site.broker().published.empty()) << site.broker().published.front().topic;
  site.broker().events->on_disconnected("left");
  connect_to_place(site, 2, "first:1883");
  site.broker().answer_subscriptions();
  site.loop().settle();
  EXPECT_TRUE(site.bridge().connected());
  EXPECT_EQ(site.broker().newest(kStatusLeft).payload, "online");
  EXPECT_EQ(site.broker().left, 1U) << "once";
}

TEST(Leaving, WaitsForCommandsUnderWay) {
  PlantSite site;
  site.bring_up_drive();
  site.connect();
  site.puppet().mute = true;
  site.command(kSet, kSame);
  site.broker().events->on_may_leave(1, true);
  site.loop().settle();
  EXPECT_EQ(site.broker().left, 0U);
  site.run(5s);
  EXPECT_FALSE(site.last_answer().empty());
  EXPECT_EQ(site.broker().left, 1U);
}

TEST(Leaving, IsCalledOffWhereTheFirstIsGoneAgain) {
  PlantSite site;
  site.bring_up_drive();
  site.connect();
  site.puppet().mute = true;
  site.command(kSet, kSame);
  site.broker().events->on_may_leave(1, true);
  site.run(100ms);
  site.broker().events->on_may_leave(1, false);
  site.run(5s);
  EXPECT_FALSE(site.last_answer().empty());
  EXPECT_EQ(site.broker().left, 0U);
}

/// 5 stops the drive; it is stopped where MQTT says nothing for 2 s.
config::Model guarded_model() {
  config::Model model = PlantSite::bridge_model();
  model.drives[0].node.motor.control = canopen::ObjectAddress{0x2000, 1};
  model.drives[0].node.motor.stops = {{.equals = 5}};
  model.drives[0].commands.timeout = 2s;
  return model;
}

TEST(Leaving, WaitsWhileADriveRunsWhoseTimeoutCountsOnMqtt) {
  PlantSite site(guarded_model());
  site.bring_up_drive();
  site.connect();
  site.command("pump1/set", R"({"frequency_command":30.0,"control_command":1})");
  site.send_values(0x0001, 3000, 4);
  site.broker().events->on_may_leave(1, true);
  for (int i = 0; i < 10; ++i) {
    site.run(1s);
    site.receive({.topic = "canopen/line3/pump1/control/alive", .payload = "x"});
  }
  EXPECT_EQ(site.broker().left, 0U);
  EXPECT_EQ(std::ranges::count_if(site.notices(), [](const std::string& text) { return contains(text, "pump1"); }), 1)
      << testing::PrintToString(site.notices());
  site.command("pump1/control_command/set", "5");
  site.run(2s);
  EXPECT_EQ(site.broker().left, 1U);
  EXPECT_TRUE(contains(site.retained("pump1/control"), R"("timeout":false)") || site.retained("pump1/control").empty())
      << site.retained("pump1/control");
}

TEST(Leaving, DoesNotWaitForADriveThatStandsStill) {
  PlantSite site(guarded_model());
  site.bring_up_drive();
  site.connect();
  site.command("pump1/control_command/set", "5");
  site.run(1s);
  site.broker().events->on_may_leave(1, true);
  site.run(100ms);
  EXPECT_EQ(site.broker().left, 1U);
}

TEST(Leaving, ACommandThatComesMeanwhileIsRefusedAndAnswered) {
  PlantSite site;
  site.bring_up_drive();
  site.connect();
  site.command(kSet, R"({"value":20.0,"id":"a0"})");
  site.run(100ms);
  site.broker().events->on_may_leave(1, true);
  site.loop().settle();
  ASSERT_EQ(site.broker().left, 1U);
  const std::size_t written = site.puppet().written.size();
  const std::size_t rpdos = site.puppet().rpdos.size();
  site.broker().forget();
  site.command(kSet, kSame);
  site.run(100ms);
  EXPECT_TRUE(contains(site.last_answer(), "\"code\":\"offline\"")) << site.last_answer();
  EXPECT_TRUE(contains(site.last_answer(), "\"a1\"")) << site.last_answer();
  site.command(kSet, R"({"value":20.0,"id":"a0"})");
  EXPECT_TRUE(contains(site.last_answer(), "\"duplicate\"")) << site.last_answer();
  site.receive({.topic = "canopen/line3/pump1/frequency_command/set", .payload = "12", .retained = true}, 100ms);
  EXPECT_TRUE(contains(site.last_answer(), "\"retained\"")) << site.last_answer();
  EXPECT_EQ(site.retained("pump1/frequency_command/set"), "") << "emptied";
  EXPECT_EQ(site.puppet().written.size(), written);
  EXPECT_EQ(site.puppet().rpdos.size(), rpdos);
  site.broker().events->on_disconnected("left");
  connect_to_place(site, 2, "first:1883");
  site.broker().answer_subscriptions();
  site.command(kSet, kSame);
  site.run(100ms);
  EXPECT_TRUE(contains(site.last_answer(), "\"ok\":true")) << "it may come again there: " << site.last_answer();
}

TEST(Leaving, AStopThatComesMeanwhileIsCarriedOut) {
  PlantSite site(guarded_model());
  site.bring_up_drive();
  site.connect();
  site.broker().events->on_may_leave(1, true);
  site.loop().settle();
  ASSERT_EQ(site.broker().left, 1U);
  site.command("pump1/control_command/set", "5");
  site.run(100ms);
  EXPECT_TRUE(contains(site.last_answer(), "\"ok\":true")) << site.last_answer();
}

TEST(Leaving, OfAConnectionThatIsGoneDoesNothing) {
  PlantSite site;
  site.bring_up_drive();
  site.connect();
  site.broker().events->on_disconnected("gone");
  site.broker().events->on_may_leave(1, true);
  site.connect(2);
  site.broker().events->on_may_leave(1, true);
  site.run(1s);
  EXPECT_EQ(site.broker().left, 0U);
  EXPECT_TRUE(site.bridge().connected());
}

TEST(OverBrokers, ACommandThatWasCarriedOutIsARepetitionAtTheNext) {
  PlantSite site;
  site.bring_up_drive();
  connect_to_place(site, 1, "first:1883");
  site.broker().answer_subscriptions();
  site.command(kSet, kSame);
  site.run(100ms);
  EXPECT_TRUE(contains(site.last_answer(), "\"ok\":true")) << site.last_answer();
  const std::size_t written = site.puppet().written.size();
  site.broker().events->on_disconnected("gone");
  connect_to_place(site, 2, "second:1883");
  site.broker().answer_subscriptions();
  site.command(kSet, kSame);
  site.run(100ms);
  EXPECT_TRUE(contains(site.last_answer(), "\"duplicate\"")) << site.last_answer();
  site.receive({.topic = "canopen/line3/pump1/frequency_command/set", .payload = "12", .retained = true}, 100ms);
  EXPECT_TRUE(contains(site.last_answer(), "\"retained\"")) << site.last_answer();
  EXPECT_EQ(site.puppet().written.size(), written);
}

TEST(OverBrokers, EachIsLookedThroughOnceAndEmptiedOfItsOwn) {
  PlantSite site;
  site.bring_up_drive();
  connect_to_place(site, 1, "first:1883");
  be_shown(site, kOldSignal, "online");  // somebody may live there: emptied later
  ASSERT_TRUE(site.bridge().connected());
  site.broker().events->on_disconnected("gone");
  connect_to_place(site, 2, "second:1883");
  be_shown(site, "canopen/line3/pump1/older_signal");
  site.run(100s);
  EXPECT_EQ(site.broker().on("canopen/line3/pump1/older_signal"), std::vector<std::string>{""});
  EXPECT_TRUE(site.broker().on(kOldSignal).empty()) << "it is the other one's";
  site.broker().events->on_disconnected("gone");
  connect_to_place(site, 3, "first:1883");
  site.broker().answer_subscriptions();
  EXPECT_TRUE(site.bridge().connected()) << "not looked through again";
  site.run(100s);
  EXPECT_EQ(site.broker().on(kOldSignal), std::vector<std::string>{""});
}

TEST(OverBrokers, AddressesOfOneNameMayBeBrokersOfTheirOwn) {
  PlantSite site;
  site.bring_up_drive();
  for (const ConnectionId id : {1U, 2U}) {
    connect_to_place(site, id, "cluster:1883", "192.0.2." + std::to_string(id));
    ASSERT_EQ(site.broker().subscribed.size(), 1U) << "the look";
    be_shown(site, kOldSignal);
    EXPECT_EQ(site.bridge().broker_health().broker, "cluster:1883");
    site.broker().events->on_disconnected("gone");
  }
  connect_to_place(site, 3, "cluster:1883", "192.0.2.1");
  EXPECT_GT(site.broker().subscribed.size(), 1U);
}

}  // namespace
}  // namespace mqtt
