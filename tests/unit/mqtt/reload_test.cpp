// What the broker is told, and what commands become of, when the plant's configuration changes while it runs.

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "bridges/mqtt/bridge.h"
#include "tests/unit/mqtt/plant_site.h"

namespace mqtt {
namespace {

using namespace std::chrono_literals;
using test::contains;
using test::PlantSite;

constexpr canopen::ObjectAddress kControlWord{0x2000, 1};
const std::string kRoot = "canopen/line3/";
const std::string kStopWord = "5";

/// `pump1`, which may be stopped by a word.
config::Model pump_alone() {
  config::Model model = PlantSite::bridge_model();
  model.drives[0].node.motor.control = kControlWord;
  model.drives[0].node.motor.stops = {{.mask = 0xFFFF, .equals = 5}};
  return model;
}

/// A drive of the same kind that is not on the bus.
config::Drive absent(const std::string& name, std::uint8_t node) {
  config::Drive drive = pump_alone().drives[0];
  drive.name = name;
  drive.unit = node;
  drive.node.node = node;
  drive.node.tpdos[0].cob_id = 0x180U + node;
  drive.node.rpdos[0].cob_id = 0x200U + node;
  return drive;
}

config::Model pump_and_fan() {
  config::Model model = pump_alone();
  model.drives.push_back(absent("fan1", 6));
  return model;
}

config::Model fan_alone() {
  config::Model model = pump_alone();
  model.drives[0] = absent("fan1", 6);
  return model;
}

/// The same drive without its last signal, `brake`.
config::Model pump_without_brake() {
  config::Model model = pump_alone();
  model.drives[0].signals.pop_back();
  return model;
}

Incoming stop_of(const std::string& drive) {
  return {.topic = kRoot + drive + "/control_command/set", .payload = kStopWord};
}

class Reload : public testing::Test {
 protected:
  /// All is told and at rest.
  static void begin(PlantSite& site) {
    site.bring_up_drive();
    site.connect();
    site.run(4s);
    site.broker().forget();
  }
  static std::vector<std::string> told_below(PlantSite& site, const std::string& parent) {
    std::vector<std::string> told;
    for (const Message& message : site.broker().published) {
      if (message.topic.starts_with(kRoot + parent)) {
        told.push_back(message.topic + "=" + message.payload);
      }
    }
    return told;
  }
  /// What a broker would still keep there.
  static std::vector<std::string> kept_below(PlantSite& site, const std::string& parent) {
    std::vector<std::string> kept;
    for (const auto& [topic, payload] : site.broker().retained) {
      if (topic.starts_with(kRoot + parent) && !payload.empty()) {
        kept.push_back(topic);
      }
    }
    return kept;
  }
  static bool is_stop(PlantSite& site, const std::string& drive) {
    return site.broker().events->is_stop(stop_of(drive));
  }
  using Nothing = std::vector<std::string>;
};

TEST_F(Reload, ADriveThatComesIsToldAsAtAConnectionAndNothingElseIs) {
  PlantSite site(pump_alone());
  begin(site);
  const std::size_t subscriptions = site.broker().subscribed.size();
  site.change(pump_and_fan());
  site.run(1s);
  EXPECT_EQ(told_below(site, "pump1/"), Nothing());
  EXPECT_EQ(site.retained("fan1/status"), "offline");
  EXPECT_TRUE(contains(site.retained("fan1/state"), R"("online":false)")) << site.retained("fan1/state");
  EXPECT_TRUE(contains(site.retained("fan1/control"), R"("holder":null)")) << site.retained("fan1/control");
  EXPECT_EQ(site.broker().on(kRoot + "fan1/output_frequency"), std::vector<std::string>{""});
  EXPECT_EQ(site.broker().on(kRoot + "info").size(), 1U);
  EXPECT_TRUE(contains(site.retained("info"), R"("name":"fan1")")) << site.retained("info");
  EXPECT_EQ(site.broker().on(kRoot + "status"), Nothing()) << "`B/status` says nothing new";
  EXPECT_EQ(site.broker().subscribed.size(), subscriptions);
  EXPECT_EQ(site.broker().opened, 1U) << "the same connection";
}

TEST_F(Reload, ADriveThatStaysKeepsItsPace) {
  PlantSite site(pump_alone());
  begin(site);
  site.send_values(0, 1000, 3);
  site.run(50ms);
  EXPECT_EQ(site.broker().on(kRoot + "pump1/output_frequency"), std::vector<std::string>{"10.00"});
  site.change(pump_and_fan());
  site.send_values(0, 1100, 3);
  site.run(100ms);
  EXPECT_EQ(site.broker().on(kRoot + "pump1/output_frequency").size(), 1U) << "not before `min_interval`";
  site.run(200ms);
  EXPECT_EQ(site.broker().on(kRoot + "pump1/output_frequency"), (std::vector<std::string>{"10.00", "11.00"}));
}

TEST_F(Reload, OfADriveThatGoesNothingIsLeft) {
  PlantSite site(pump_and_fan());
  begin(site);
  ASSERT_TRUE(contains(site.retained("alarms"), R"("drive":"fan1")")) << "it is missed";
  site.change(pump_alone());
  site.run(1s);
  EXPECT_EQ(kept_below(site, "fan1/"), Nothing());
  EXPECT_EQ(site.broker().on(kRoot + "fan1/status"), (std::vector<std::string>{"offline", ""}));
  EXPECT_EQ(told_below(site, "pump1/"), Nothing());
  EXPECT_FALSE(contains(site.retained("info"), "fan1")) << site.retained("info");
  EXPECT_FALSE(contains(site.retained("alarms"), "fan1")) << site.retained("alarms");
  site.command("fan1/frequency_command/set", R"({"value":1,"id":"a"})");
  EXPECT_TRUE(contains(site.last_answer(), R"("code":"unknown")")) << site.last_answer();
}

TEST_F(Reload, ARenamedDriveLeavesNothingUnderItsOldName) {
  PlantSite site(pump_and_fan());
  begin(site);
  config::Model renamed = pump_and_fan();
  renamed.drives[1].name = "blower";
  site.change(renamed);
  site.run(1s);
  EXPECT_EQ(kept_below(site, "fan1/"), Nothing());
  EXPECT_EQ(site.retained("blower/status"), "offline");
}

TEST_F(Reload, AnotherOrderIsToldByNobody) {
  PlantSite site(pump_and_fan());
  begin(site);
  config::Model turned = pump_and_fan();
  std::swap(turned.drives[0], turned.drives[1]);
  site.change(turned);
  site.run(1s);
  EXPECT_EQ(told_below(site, "pump1/"), Nothing());
  EXPECT_EQ(told_below(site, "fan1/"), Nothing());
  site.send_values(0, 2000, 4);
  site.puppet().emergency(std::vector<std::uint8_t>{0x10, 0x23, 2, 0, 0, 0, 0, 0});
  site.run(500ms);
  EXPECT_EQ(site.retained("pump1/output_frequency"), "20.00");
  EXPECT_TRUE(contains(site.retained("pump1/alarm/emcy"), R"("active":true)")) << site.retained("pump1/alarm/emcy");
  EXPECT_EQ(told_below(site, "fan1/"), Nothing());
  site.command("pump1/mode/set", R"({"value":"torque","id":"a"})");
  site.run(100ms);
  EXPECT_TRUE(contains(site.last_answer(), R"("ok":true)")) << site.last_answer();
}

TEST_F(Reload, AnotherConfigurationUnderTheSameNameEmptiesWhatIsGoneAndLeavesItsAlarms) {
  PlantSite site(pump_alone());
  begin(site);
  site.puppet().dictionary[{0x1001, 0}] = {1, 1};
  site.puppet().emergency(std::vector<std::uint8_t>{0x10, 0x23, 1, 0, 0, 0, 0, 0});
  site.run(1s);
  const std::string alarm = site.retained("pump1/alarm/emcy");
  ASSERT_TRUE(contains(alarm, R"("active":true)")) << alarm;
  site.broker().forget();
  site.change(pump_without_brake());
  EXPECT_EQ(site.retained("pump1/status"), "offline");
  EXPECT_EQ(site.retained("pump1/brake"), "");
  EXPECT_FALSE(contains(site.retained("pump1/state"), "brake")) << site.retained("pump1/state");
  EXPECT_TRUE(contains(site.retained("alarms"), R"("kind":"emcy")")) << site.retained("alarms");
  for (const std::string& told : site.broker().on(kRoot + "pump1/alarm/emcy")) {
    EXPECT_TRUE(contains(told, R"("active":true)")) << told;
  }
  site.run(5s);
  EXPECT_EQ(site.retained("pump1/status"), "online");
  EXPECT_EQ(site.retained("pump1/output_frequency"), "0.00");
}

TEST_F(Reload, WhatIsUnderWayAtADriveThatStaysIsAnsweredOnce) {
  PlantSite site(pump_alone());
  begin(site);
  site.puppet().mute = true;
  site.command("pump1/mode/set", R"({"value":"torque","id":"a"})");
  EXPECT_EQ(site.last_answer(), "none");
  site.change(pump_and_fan());
  site.run_silent(3s);
  ASSERT_EQ(site.broker().on(kRoot + "result").size(), 1U);
  EXPECT_TRUE(contains(site.last_answer(), R"("code":"timeout")")) << site.last_answer();
  site.command("pump1/mode/set", R"({"value":"torque","id":"a"})");
  EXPECT_TRUE(contains(site.last_answer(), R"("code":"duplicate")")) << "it is remembered: " << site.last_answer();
}

TEST_F(Reload, WhatIsUnderWayAtADriveThatGoesIsAnsweredOffline) {
  PlantSite site(pump_alone());
  begin(site);
  site.puppet().mute = true;
  site.command("pump1/mode/set", R"({"value":"torque","id":"a"})");
  site.command("pump1/mode/set", R"({"value":"torque","id":"b"})");
  site.command("pump1/sdo/request", R"({"op":"read","object":"0x2002:03","type":"u16","id":"r"})");
  site.change(fan_alone());
  site.run_silent(3s);
  const std::vector<std::string> answers = site.broker().on(kRoot + "result");
  ASSERT_EQ(answers.size(), 2U);
  for (const std::string& answer : answers) {
    EXPECT_TRUE(contains(answer, R"("code":"offline")")) << answer;
  }
  EXPECT_EQ(site.broker().on(kRoot + "pump1/sdo/response").size(), 1U);
}

TEST_F(Reload, AStopForAllAcrossAChangeNamesTheDrivesThatItMissed) {
  PlantSite site(pump_and_fan());
  begin(site);
  site.puppet().mute = true;
  site.command("stop", R"({"value":1,"id":"a"})");
  config::Model others = pump_alone();
  others.drives.insert(others.drives.begin(), absent("blower", 7));
  site.change(others);
  site.run_silent(3s);
  ASSERT_EQ(site.broker().on(kRoot + "result").size(), 1U);
  EXPECT_TRUE(contains(site.last_answer(), "pump1 (")) << site.last_answer();
  EXPECT_TRUE(contains(site.last_answer(), "fan1 (")) << site.last_answer();
  EXPECT_FALSE(contains(site.last_answer(), "blower")) << site.last_answer();
}

TEST_F(Reload, WhatStopsADriveIsKnownOfThoseThatAreThere) {
  PlantSite site(pump_alone());
  begin(site);
  EXPECT_TRUE(is_stop(site, "pump1"));
  EXPECT_FALSE(is_stop(site, "fan1"));
  site.change(pump_and_fan());
  EXPECT_TRUE(is_stop(site, "pump1"));
  EXPECT_TRUE(is_stop(site, "fan1"));
  site.change(fan_alone());
  EXPECT_FALSE(is_stop(site, "pump1"));
  EXPECT_TRUE(is_stop(site, "fan1"));
}

TEST_F(Reload, AStopIsKnownByAnyThreadWhateverChangesMeanwhile) {
  PlantSite site(pump_alone());
  begin(site);
  std::atomic<bool> ends = false;
  std::atomic<std::size_t> asked = 0;
  std::atomic<std::size_t> missed = 0;
  const BrokerEvents& events = *site.broker().events;
  std::thread paho([&] {
    const Incoming stop = stop_of("pump1");
    do {
      missed += events.is_stop(stop) ? 0 : 1;
      ++asked;
    } while (!ends);
  });
  for (int i = 0; i < 20; ++i) {
    site.change(i % 2 == 0 ? pump_and_fan() : pump_alone());
  }
  ends = true;
  paho.join();
  EXPECT_GT(asked, 0U);
  EXPECT_EQ(missed, 0U);
}

TEST_F(Reload, WhatGoesWhileThereIsNoConnectionIsEmptiedOnTheNext) {
  PlantSite site(pump_and_fan());
  begin(site);
  site.broker().events->on_disconnected("gone");
  site.run(61s);
  site.change(pump_alone());
  EXPECT_EQ(site.broker().published.size(), 0U);
  site.connect(2);
  site.run(1s);
  EXPECT_EQ(kept_below(site, "fan1/"), Nothing());
  EXPECT_EQ(site.retained("pump1/status"), "online");
}

TEST_F(Reload, WhatWasEmptiedJustBeforeTheConnectionBrokeIsEmptiedAgain) {
  PlantSite site(pump_and_fan());
  begin(site);
  site.change(pump_alone());
  site.run(1s);
  site.broker().events->on_disconnected("gone");
  site.broker().forget();
  site.connect(2);
  site.run(61s);
  EXPECT_EQ(site.broker().on(kRoot + "fan1/status"), std::vector<std::string>{""});
  site.broker().events->on_disconnected("gone");
  site.broker().forget();
  site.connect(3);
  site.run(1s);
  EXPECT_EQ(told_below(site, "fan1/"), Nothing()) << "it has arrived";
}

TEST_F(Reload, ADriveThatComesBackIsNotEmptied) {
  PlantSite site(pump_and_fan());
  begin(site);
  site.broker().events->on_disconnected("gone");
  site.change(pump_alone());
  site.change(pump_and_fan());
  site.connect(2);
  site.run(1s);
  EXPECT_EQ(site.retained("fan1/status"), "offline");
  EXPECT_TRUE(contains(site.retained("fan1/state"), R"("online":false)")) << site.retained("fan1/state");
}

TEST_F(Reload, EachBrokerForgetsWhatWentMeanwhile) {
  PlantSite site(pump_and_fan());
  site.bring_up_drive();
  const auto connect_to = [&site](ConnectionId connection, const char* broker) {
    site.broker().events->on_connected({.id = connection, .broker = broker});
    site.loop().settle();
    site.broker().answer_subscriptions();
    site.run(1s);
  };
  connect_to(1, "10.0.0.1:1883");
  site.broker().events->on_disconnected("gone");
  connect_to(2, "10.0.0.2:1883");
  site.change(pump_alone());
  site.run(61s);
  site.broker().events->on_disconnected("gone");
  site.broker().forget();
  connect_to(3, "10.0.0.1:1883");
  EXPECT_EQ(site.broker().on(kRoot + "fan1/status"), std::vector<std::string>{""});
}

TEST_F(Reload, WhereAnotherGatewayOfOurNameLivesNothingIsEmptied) {
  PlantSite site(pump_and_fan());
  begin(site);
  site.receive(
      {.topic = kRoot + "health", .payload = R"({"ts":"2026-01-02T03:04:05.678Z","instance":"ffff222233334444"})"});
  site.change(pump_alone());
  site.run(1s);
  EXPECT_EQ(site.retained("fan1/status"), "offline");
}

}  // namespace
}  // namespace mqtt
