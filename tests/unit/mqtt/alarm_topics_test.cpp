// Alarms on MQTT: what is published, how often, and what becomes of topics that others write on.

#include "bridges/mqtt/alarm_topics.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <string>
#include <utility>

#include "bridges/alarms/alarm_json.h"
#include "tests/unit/mqtt/plant_site.h"

namespace mqtt {
namespace {

using namespace std::chrono_literals;
using test::contains;
using test::PlantSite;

constexpr const char* kEmcy = "canopen/line3/pump1/alarm/emcy";
constexpr const char* kBus = "canopen/line3/bus/can0/alarm";
constexpr const char* kList = "canopen/line3/alarms";
constexpr std::array<std::uint8_t, 8> kOvercurrent{0x10, 0x23, 0x01, 5, 0, 0, 0, 0};
constexpr std::array<std::uint8_t, 8> kNoError{};

// `site.run()` sends no new value and no emergency.
void raise(PlantSite& site) {
  site.puppet().dictionary[{0x1001, 0}].value = 1;
  site.puppet().emergency(kOvercurrent);
  site.loop().settle();
}

alarms::Alarm old_alarm() {
  alarms::Alarm alarm;
  alarm.active = true;
  alarm.known = true;
  alarm.id = "before-1";
  alarm.code = 0x2310;
  alarm.text = "Overcurrent";
  alarm.error_register = 1;
  alarm.since = canopen::WallTime(std::chrono::seconds(1000000000));
  alarm.ts = alarm.since;
  alarm.count = 3;
  alarm.errors = {{alarm.code, alarm.vendor, alarm.text, alarm.severity, alarm.since}};
  return alarm;
}

TEST(AlarmTopics, AnAlarmOfMemoryIsShownUnconfirmedUntilTheDriveIsThere) {
  PlantSite site(PlantSite::bridge_model(), old_alarm());
  site.connect();
  const std::string alarm = site.retained("pump1/alarm/emcy");
  EXPECT_TRUE(contains(alarm, R"("active":true,"id":"before-1","code":"0x2310")")) << alarm;
  EXPECT_TRUE(contains(alarm, R"("confirmed":false)")) << alarm;
  EXPECT_TRUE(contains(alarm, R"("count":3)")) << alarm;
  EXPECT_EQ(site.retained("alarms"),
            R"([{"drive":"pump1","kind":"emcy","code":"0x2310","reason":"","text":"Overcurrent","severity":"fault",)"
            R"("since":"2001-09-09T01:46:40.000Z","first":false}])");
  EXPECT_EQ(site.broker().published.back().topic, "canopen/line3/status") << "`online` is said behind it";
  site.bring_up_drive();  // its error register says that nothing is active
  EXPECT_TRUE(contains(site.retained("pump1/alarm/emcy"), R"("active":false)")) << site.retained("pump1/alarm/emcy");
  EXPECT_EQ(site.retained("alarms"), "[]");
}

TEST(AlarmTopics, WithoutMemoryAnAlarmIsLeftUntilItIsDecided) {
  for (const bool is_there : {false, true}) {
    PlantSite site;
    site.puppet().mute = !is_there;
    site.connect();
    EXPECT_EQ(site.retained("status"), "online");
    for (const char* kind : {"emcy", "heartbeat", "boot", "data"}) {
      const std::string topic = "pump1/alarm/" + std::string(kind);
      EXPECT_EQ(site.retained(topic), "never published") << kind;
      site.receive({.topic = "canopen/line3/" + topic, .payload = "of somebody", .retained = false});
      EXPECT_EQ(site.retained(topic), "never published") << "nor put right: " << kind;
    }
    EXPECT_EQ(site.retained("alarms"), "never published") << "an empty one would say that nothing is wrong";
    if (is_there) {
      site.bring_up_drive();
    } else {
      site.loop().advance(5s, 10ms);
    }
    EXPECT_TRUE(contains(site.retained("pump1/alarm/heartbeat"), is_there ? R"("active":false)" : R"("active":true)"))
        << site.retained("pump1/alarm/heartbeat");
    for (const char* kind : {"emcy", "boot", "data"}) {
      EXPECT_TRUE(contains(site.retained("pump1/alarm/" + std::string(kind)), R"("active":false)")) << kind;
    }
    EXPECT_EQ(contains(site.retained("alarms"), R"("kind":"heartbeat")"), !is_there) << site.retained("alarms");
  }
}

TEST(AlarmTopics, ALongSearchCallsNoAlarmOver) {
  config::Model model = PlantSite::bridge_model();
  model.drives[0].node.error_control.heartbeat_timeout = 30s;
  PlantSite site(std::move(model));
  site.puppet().mute = true;
  site.connect();
  site.loop().advance(25s, 100ms);
  EXPECT_EQ(site.retained("pump1/alarm/heartbeat"), "never published");
  site.loop().advance(20s, 100ms);
  EXPECT_TRUE(contains(site.retained("pump1/alarm/heartbeat"), R"("active":true)"))
      << site.retained("pump1/alarm/heartbeat");
}

TEST(AlarmTopics, AlarmsOfADriveThatRestartsAllTheTimeAreToldAfterAWhile) {
  PlantSite site;
  site.puppet().mute = true;
  site.connect();
  for (int i = 0; i < 80; ++i) {
    EXPECT_EQ(i < 70 ? site.retained("pump1/alarm/heartbeat") : "never published", "never published") << i;
    site.puppet().boot_up();
    site.loop().advance(200ms, 10ms);
  }
  EXPECT_TRUE(contains(site.retained("pump1/alarm/heartbeat"), R"("active":false)"));
  EXPECT_TRUE(contains(site.retained("pump1/alarm/data"), R"("active":false)"));
}

TEST(AlarmTopics, AStormIsToldByFewMessagesAndItsEndIsTrue) {
  PlantSite site;
  site.bring_up_drive();
  site.connect();
  site.run(1s);
  site.broker().forget();
  const std::uint32_t before = site.plant().drive(0).alarm(alarms::AlarmKind::emcy).count;
  for (int i = 0; i < 1000; ++i) {
    site.puppet().dictionary[{0x1001, 0}].value = i % 2 == 0 ? 1 : 0;
    site.puppet().emergency(i % 2 == 0 ? kOvercurrent : kNoError);
    if (i % 50 == 0) {
      site.puppet().heartbeat();
    }
    site.loop().advance(1ms);
  }
  EXPECT_GE(site.broker().on(kEmcy).size(), 3U);
  site.run(2s);
  EXPECT_LE(site.broker().on(kEmcy).size(), 4U);
  EXPECT_LE(site.broker().on(kList).size(), 4U);
  const alarms::Alarm& alarm = site.plant().drive(0).alarm(alarms::AlarmKind::emcy);
  EXPECT_EQ(alarm.count, before + 500);
  EXPECT_FALSE(alarm.active);
  EXPECT_EQ(site.retained("pump1/alarm/emcy"), alarms::alarm_json(alarm));
  EXPECT_EQ(site.retained("alarms"), "[]");
}

TEST(AlarmTopics, WhatIsHeldBackIsToldAtAnOrderlyEnd) {
  PlantSite site;
  site.bring_up_drive();
  site.connect();
  raise(site);
  site.puppet().dictionary[{0x1001, 0}].value = 0;
  site.puppet().emergency(kNoError);
  site.loop().settle();
  ASSERT_TRUE(contains(site.retained("pump1/alarm/emcy"), R"("active":true)")) << "held back";
  site.stop_bridge();
  const auto& last = site.broker().last_words;
  const auto told = std::find_if(last.begin(), last.end(), [](const Message& each) { return each.topic == kEmcy; });
  ASSERT_NE(told, last.end());
  EXPECT_TRUE(contains(told->payload, R"("active":false)")) << told->payload;
  EXPECT_EQ(
      std::count_if(last.begin(), last.end(), [](const Message& each) { return each.kind == MessageKind::alarm; }), 2)
      << "and the list";
}

TEST(AlarmTopics, TheFirstChangeIsToldAtOnceEvenOnTheHeelsOfAnotherAlarm) {
  PlantSite site;
  site.bring_up_drive();
  site.connect();
  raise(site);
  EXPECT_TRUE(contains(site.retained("alarms"), R"("drive":"pump1","kind":"emcy","code":"0x2310")"))
      << site.retained("alarms");
  site.plant().set_bus_state(0, {canopen::BusCondition::bus_off, 0, 0});
  site.loop().settle();
  EXPECT_TRUE(contains(site.retained("bus/can0/alarm"), R"("active":true)")) << site.retained("bus/can0/alarm");
  EXPECT_FALSE(contains(site.retained("alarms"), R"("bus":"can0")")) << "the list has a pace of its own";
  site.run(500ms);
  EXPECT_TRUE(contains(site.retained("alarms"), R"({"bus":"can0","kind":"bus","code":"0x0000",)"))
      << site.retained("alarms");
}

TEST(AlarmTopics, NothingIsPublishedThatDidNotChange) {
  PlantSite site;
  site.bring_up_drive();
  site.connect();
  raise(site);
  site.run(2s);
  site.broker().forget();
  for (std::uint8_t count = 1; count <= 20; ++count) {
    site.plant().set_bus_state(0, {canopen::BusCondition::error_active, count, 0});
    site.run(100ms);
  }
  EXPECT_TRUE(site.broker().on(kBus).empty());
  site.puppet().dictionary[{0x1001, 0}].value = 0x81;
  site.puppet().emergency(std::array<std::uint8_t, 8>{0x10, 0x23, 0x81, 5, 0, 0, 0, 0});
  site.run(2s);
  EXPECT_EQ(site.broker().on(kEmcy).size(), 1U) << "the error register";
  EXPECT_TRUE(site.broker().on(kList).empty()) << "which the list does not show";
}

TEST(AlarmTopics, WhatSomebodyElseWritesIsPutRight) {
  for (const std::string topic : {kEmcy, kBus, kList}) {
    for (const char* written : {"", "{}", "online"}) {
      PlantSite site;
      site.bring_up_drive();
      site.connect();
      raise(site);
      site.run(1s);
      const std::string before = site.broker().retained[topic];
      site.broker().forget();
      site.receive({.topic = topic, .payload = written});
      EXPECT_EQ(site.broker().on(topic), std::vector<std::string>{before}) << topic << " " << written;
      for (int i = 0; i < 30; ++i) {  // for 3 s
        site.receive({.topic = topic, .payload = written}, 100ms);
      }
      EXPECT_GE(site.broker().on(topic).size(), 3U) << topic;
      EXPECT_LE(site.broker().on(topic).size(), 4U) << topic;
      site.run(1s);
      site.broker().forget();
      site.run(3s);
      EXPECT_TRUE(site.broker().on(topic).empty()) << "once it is right";
    }
  }
}

TEST(AlarmTopics, OwnMessagesAndWhatWasThereBeforeAreLeft) {
  PlantSite site;
  site.bring_up_drive();
  site.connect();
  const std::string over = site.retained("pump1/alarm/emcy");
  raise(site);
  const std::string active = site.retained("pump1/alarm/emcy");
  const std::vector<std::string> said = site.notices();
  site.broker().forget();
  site.receive({.topic = kEmcy, .payload = "of another time", .retained = true});
  site.receive({.topic = kEmcy, .payload = over});
  site.receive({.topic = kEmcy, .payload = active});
  for (const char* topic : {"canopen/line3/gone/alarm/emcy", "canopen/line3/bus/can7/alarm",
                            "canopen/line3/pump1/alarm/unknown", "canopen/line4/alarms"}) {
    site.receive({.topic = topic, .payload = "{}"});
  }
  site.run(5s);
  EXPECT_TRUE(site.broker().published.empty()) << site.broker().published.front().topic;
  EXPECT_EQ(site.notices(), said);
}

TEST(AlarmTopics, AnAlarmThatSomebodyWritesIsNotTakenForOurs) {
  PlantSite site;
  site.bring_up_drive();
  site.connect();
  site.receive({.topic = kEmcy, .payload = alarms::alarm_json(old_alarm())});
  EXPECT_FALSE(site.plant().drive(0).alarm(alarms::AlarmKind::emcy).active);
  EXPECT_TRUE(contains(site.retained("pump1/alarm/emcy"), R"("active":false)"));
}

}  // namespace
}  // namespace mqtt
