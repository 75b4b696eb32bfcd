#include "bridges/mqtt/bridge.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <string>
#include <utility>

#include "tests/unit/mqtt/plant_site.h"

namespace mqtt {
namespace {

using namespace std::chrono_literals;
using test::contains;
using test::PlantSite;

TEST(MqttBridge, AnnouncesEverythingAndOnlineLast) {
  PlantSite site;
  site.bring_up_drive();
  EXPECT_TRUE(site.broker().published.empty()) << "nothing before the connection";
  site.connect();
  ASSERT_FALSE(site.broker().published.empty());
  EXPECT_EQ(site.broker().published.back(), (Message{.topic = "canopen/line3/status",
                                                     .payload = "online",
                                                     .kind = MessageKind::status,
                                                     .expiry = 180,
                                                     .after_all = true}));
  EXPECT_EQ(site.broker().opened, 1U);
  EXPECT_TRUE(site.bridge().connected());
  EXPECT_EQ(site.retained("pump1/status"), "online");
  EXPECT_EQ(site.retained("pump1/control"), R"({"holder":null,"since":null,"timeout":false})");
  for (const char* alarm : {"pump1/alarm/emcy", "pump1/alarm/heartbeat", "pump1/alarm/boot", "pump1/alarm/data",
                            "pump1/alarm/control", "bus/can0/alarm"}) {
    EXPECT_TRUE(contains(site.retained(alarm), R"("active":false)")) << alarm << ": " << site.retained(alarm);
  }
  EXPECT_EQ(site.retained("alarms"), "[]");
  EXPECT_TRUE(contains(site.retained("info"), R"("version":"1.2.3")"));
  EXPECT_TRUE(contains(site.retained("info"), R"("assumed_pdos":["TPDO1","RPDO1"])"));
  EXPECT_TRUE(contains(
      site.retained("info"),
      R"({"name":"frequency_command","object":"0x2000:02","type":"u16","scale":0.01,"unit":"","access":"write",)"
      R"("source":"rpdo1","min":0,"max":50,"values":null,"topic":null,"set":"canopen/line3/pump1/frequency_command/set"})"))
      << site.retained("info");
  EXPECT_EQ(site.retained("pump1/frequency_command"), "never published");
  EXPECT_TRUE(std::all_of(site.broker().published.begin(), site.broker().published.end(),
                          [](const Message& message) { return message.retained; }));
}

TEST(MqttBridge, ADriveOutOfServiceIsOfflineWithoutAlarms) {
  config::Model model = PlantSite::bridge_model();
  model.drives[0].enabled = false;
  PlantSite site(std::move(model));
  site.puppet().boot_up();
  site.run(100ms);
  site.connect();
  EXPECT_EQ(site.retained("pump1/status"), "offline");
  EXPECT_TRUE(contains(site.retained("pump1/state"), R"("online":false,)")) << site.retained("pump1/state");
  // Nothing of it will ever be learnt, so nothing is waited for.
  for (const char* alarm :
       {"pump1/alarm/emcy", "pump1/alarm/heartbeat", "pump1/alarm/boot", "pump1/alarm/data", "pump1/alarm/control"}) {
    EXPECT_TRUE(contains(site.retained(alarm), R"("active":false)")) << alarm << ": " << site.retained(alarm);
  }
  site.command("pump1/frequency_command/set", "10");
  EXPECT_TRUE(contains(site.last_answer(), R"("code":"offline")")) << site.last_answer();
  EXPECT_TRUE(contains(site.last_answer(), "out of service")) << site.last_answer();
  site.run(5s);
  EXPECT_TRUE(site.puppet().written.empty());
  EXPECT_TRUE(site.puppet().nmt_commands.empty());
}

TEST(MqttBridge, ShowsTheStateOfADrive) {
  PlantSite site;
  site.bring_up_drive();
  site.send_values(0x0001, 4997, 4, 0x0005);
  site.connect();
  // The time stamp is that of the newest value, which the clock of the test gave.
  const std::string state = site.retained("pump1/state");
  EXPECT_TRUE(contains(state, R"({"ts":"2026-01-02T03:04:0)")) << state;
  EXPECT_TRUE(contains(state, R"(Z","online":true,"nmt":"operational","fresh":true,"values":{"status_word":1,)"
                              R"("output_frequency":49.97,"drive_state":"running","drive_state_code":4,"fault_code":5,)"
                              R"("running":true,"mode":"speed","mode_code":0,"brake":true}})"))
      << state;
  EXPECT_EQ(site.retained("pump1/output_frequency"), "49.97");
  EXPECT_EQ(site.retained("pump1/running"), "true");
  EXPECT_EQ(site.retained("pump1/fault_code"), "5");
  EXPECT_EQ(site.retained("pump1/mode"), "speed");
}

TEST(MqttBridge, OneTurnOfTheLoopIsOneBatchAndOnePdoOneState) {
  PlantSite site;
  site.bring_up_drive();
  site.connect();
  site.run(1s);
  site.broker().forget();
  site.send_values(0x0001, 3000, 4);
  EXPECT_EQ(site.broker().batches, 1U);
  const auto states = site.broker().on("canopen/line3/pump1/state");
  ASSERT_EQ(states.size(), 1U);
  EXPECT_TRUE(contains(states[0], R"("output_frequency":30.00,"drive_state":"running")")) << states[0];
  EXPECT_EQ(site.broker().on("canopen/line3/pump1/output_frequency"), std::vector<std::string>{"30.00"});
}

TEST(MqttBridge, AFastValueIsPublishedEveryShortestIntervalWithItsNewestValue) {
  PlantSite site;
  site.bring_up_drive();
  site.connect();
  site.run(1s);
  site.broker().forget();
  for (std::uint16_t i = 1; i <= 100; ++i) {  // 1 s at 100 Hz
    site.puppet().heartbeat();
    site.send_values(0, i, 3);
    site.loop().advance(10ms);
  }
  const auto values = site.broker().on("canopen/line3/pump1/output_frequency");
  EXPECT_GE(values.size(), 4U);
  EXPECT_LE(values.size(), 5U);
  site.loop().advance(250ms);
  EXPECT_EQ(site.retained("pump1/output_frequency"), "1.00");
  EXPECT_TRUE(contains(site.retained("pump1/state"), R"("output_frequency":1.00)"));
}

TEST(MqttBridge, WithoutAChangeNothingIsPublishedUntilTheLongestInterval) {
  PlantSite site;
  site.bring_up_drive();
  site.connect();
  site.run(1s);
  site.broker().forget();
  site.run(30s);
  EXPECT_TRUE(site.broker().published.empty()) << site.broker().published.front().topic;
  site.run(40s);
  EXPECT_EQ(site.broker().on("canopen/line3/pump1/output_frequency").size(), 1U);
  EXPECT_EQ(site.broker().on("canopen/line3/pump1/state").size(), 1U);
}

TEST(MqttBridge, AValueThatIsNotFreshIsEmptiedAndNull) {
  PlantSite site;
  site.bring_up_drive();
  site.send_values(0x0001, 3000, 4);
  site.connect();
  EXPECT_EQ(site.retained("pump1/output_frequency"), "30.00");
  for (std::uint8_t sub = 1; sub <= 4; ++sub) {
    site.puppet().dictionary.erase({0x2021, sub});  // else SDO reads take the place of the TPDO
  }
  site.run_silent(2s);
  EXPECT_EQ(site.retained("pump1/output_frequency"), "");
  EXPECT_EQ(site.retained("pump1/running"), "");
  EXPECT_EQ(site.retained("pump1/state").find("30.00"), std::string::npos);
  EXPECT_TRUE(contains(site.retained("pump1/state"),
                       R"("fresh":false,"values":{"status_word":null,"output_frequency":null,)"
                       R"("drive_state":null,"drive_state_code":null)"))
      << site.retained("pump1/state");
  site.send_values(0x0001, 3000, 4);
  EXPECT_EQ(site.retained("pump1/output_frequency"), "30.00");
}

TEST(MqttBridge, ALostDriveIsOfflineAtOnceWithItsAlarm) {
  PlantSite site;
  site.bring_up_drive();
  site.connect();
  site.puppet().mute = true;
  site.loop().advance(5s, 10ms);
  EXPECT_EQ(site.retained("pump1/status"), "offline");
  EXPECT_TRUE(contains(site.retained("pump1/state"), R"("online":false)"));
  EXPECT_TRUE(contains(site.retained("pump1/alarm/heartbeat"), R"("active":true)"))
      << site.retained("pump1/alarm/heartbeat");
  EXPECT_EQ(site.retained("pump1/brake"), "");
}

TEST(MqttBridge, AnEmergencyIsAnAlarmAtOnce) {
  PlantSite site;
  site.bring_up_drive();
  site.connect();
  site.puppet().dictionary[{0x1001, 0}].value = 1;
  site.puppet().emergency(std::array<std::uint8_t, 8>{0x10, 0x23, 0x01, 5, 0, 0, 0, 0});
  site.loop().settle();
  const std::string alarm = site.retained("pump1/alarm/emcy");
  EXPECT_TRUE(contains(alarm, R"("active":true)")) << alarm;
  EXPECT_TRUE(contains(alarm, R"("code":"0x2310")")) << alarm;
  EXPECT_TRUE(contains(alarm, R"("vendor":"0500000000")")) << alarm;
  EXPECT_TRUE(contains(alarm, R"("confirmed":true)")) << alarm;
}

TEST(MqttBridge, EverythingRetainedIsPublishedAgainAfterEachConnection) {
  PlantSite site;
  site.bring_up_drive();
  site.connect();
  const auto before = site.broker().retained;
  site.broker().events->on_disconnected("gone");
  site.loop().settle();
  EXPECT_FALSE(site.bridge().connected());
  site.broker().forget();
  site.broker().retained.clear();
  site.send_values(0x0001, 1234, 4);
  EXPECT_TRUE(site.broker().published.empty());
  site.connect(2);
  EXPECT_EQ(site.broker().retained.size(), before.size());
  EXPECT_EQ(site.retained("pump1/output_frequency"), "12.34");
  EXPECT_EQ(site.broker().opened, 2U);
  EXPECT_EQ(site.broker().published.back().topic, "canopen/line3/status");
}

TEST(MqttBridge, AnOrderlyEndSetsEveryStatusToOffline) {
  PlantSite site;
  site.bring_up_drive();
  site.connect();
  site.stop_bridge();
  ASSERT_GE(site.broker().last_words.size(), 2U);
  EXPECT_EQ(
      site.broker().last_words.back(),
      (Message{.topic = "canopen/line3/status", .payload = "offline", .kind = MessageKind::status, .after_all = true}));
  EXPECT_EQ(site.broker().last_words[site.broker().last_words.size() - 2],
            (Message{.topic = "canopen/line3/pump1/status", .payload = "offline", .kind = MessageKind::status}));
  EXPECT_FALSE(site.bridge().connected());
}

TEST(MqttBridge, TheLookThatIsGivenBackDuringTheEndBringsNoSubscriptions) {
  PlantSite site;
  site.broker().events->on_connected({.id = 1});
  ASSERT_EQ(site.broker().subscribed.size(), 1U) << "the look";
  const std::string look = site.broker().subscribed[0].filter;
  site.broker().events->on_subscribed({.filter = look});
  site.run(1s);
  ASSERT_EQ(site.broker().unsubscribed, std::vector<std::string>{look});
  site.broker().while_stopping = [&] { site.broker().events->on_unsubscribed(look); };
  site.stop_bridge();
  EXPECT_EQ(site.broker().subscribed.size(), 1U) << "the last words are said";
}

TEST(MqttBridge, TellsWhenItIsConnected) {
  PlantSite site;
  std::vector<bool> changes;
  site.bridge().on_connected_change([&changes](bool connected) { changes.push_back(connected); });
  site.connect();
  site.broker().events->on_disconnected("gone");
  EXPECT_EQ(changes, (std::vector<bool>{true, false}));
}

TEST(MqttBridge, ADeniedSubscriptionIsSaid) {
  PlantSite site;
  site.broker().events->on_connected({.id = 1});
  site.broker().answer_subscriptions("not authorized");
  ASSERT_EQ(site.notices().size(), site.broker().subscribed.size()) << "each by its name";
  for (std::size_t i = 0; i < site.notices().size(); ++i) {
    EXPECT_TRUE(contains(site.notices()[i], site.broker().subscribed[i].filter + " is refused: not authorized"))
        << site.notices()[i];
  }
  site.loop().settle();
  EXPECT_TRUE(site.bridge().connected()) << "values go out all the same";
}

TEST(MqttBridge, APulseWithinOneTurnIsToldInOrder) {
  PlantSite site;
  site.bring_up_drive();
  site.connect();
  site.run(1s);
  site.broker().forget();
  site.puppet().tpdo(1, std::array<std::uint8_t, 7>{1, 0, 0, 0, 4, 0, 0});
  site.puppet().tpdo(1, std::array<std::uint8_t, 7>{0, 0, 0, 0, 3, 0, 0});
  site.loop().settle();
  EXPECT_EQ(site.broker().batches, 1U) << "both came in one turn";
  EXPECT_EQ(site.broker().on("canopen/line3/pump1/running"), (std::vector<std::string>{"true", "false"}));
  EXPECT_EQ(site.broker().on("canopen/line3/pump1/drive_state"), (std::vector<std::string>{"running", "stopped"}));
  const auto states = site.broker().on("canopen/line3/pump1/state");
  ASSERT_EQ(states.size(), 2U);
  EXPECT_TRUE(contains(states[0], R"("drive_state":"running","drive_state_code":4,"fault_code":0,"running":true)"))
      << states[0];
  EXPECT_TRUE(contains(states[1], R"("drive_state":"stopped","drive_state_code":3,"fault_code":0,"running":false)"))
      << states[1];
}

TEST(MqttBridge, NumbersAloneAreToldOnceATurn) {
  PlantSite site;
  site.bring_up_drive();
  site.connect();
  site.run(1s);
  site.loop().advance(4ms);  // behind the last batch
  site.broker().forget();
  for (std::uint8_t frequency = 1; frequency <= 50; ++frequency) {
    site.puppet().tpdo(1, std::array<std::uint8_t, 7>{0, 0, frequency, 0, 3, 0, 0});
  }
  site.loop().settle();
  EXPECT_EQ(site.broker().on("canopen/line3/pump1/output_frequency"), std::vector<std::string>{"0.50"});
  EXPECT_EQ(site.broker().on("canopen/line3/pump1/state").size(), 1U);
}

}  // namespace
}  // namespace mqtt
