// When Home Assistant is told of the drives, and what is removed there.

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "bridges/mqtt/bridge.h"
#include "bridges/mqtt/home_assistant/discovery.h"
#include "tests/unit/mqtt/plant_site.h"

namespace mqtt {
namespace {

using namespace std::chrono_literals;
using home_assistant::Discovery;
using test::contains;
using test::PlantSite;

constexpr const char* kPumpConfig = "homeassistant/device/canopen_line3/pump1/config";
constexpr const char* kGoneConfig = "homeassistant/device/canopen_line3/old/config";
constexpr const char* kMemory = "canopen/line3/home_assistant";
constexpr const char* kBirthTopic = "homeassistant/status";
constexpr const char* kConfigFilter = "homeassistant/device/canopen_line3/+/config";
constexpr const char* kKeptConfig = R"({"availability":[{"topic":"canopen/line3/status"}],"components":{)"
                                    R"("sensor_old":{"platform":"sensor","name":"Old"},)"
                                    R"("sensor_output_frequency":{"platform":"sensor","name":"x"}}})";

config::Model model_with(std::string prefix) {
  config::Model model = PlantSite::bridge_model();
  model.mqtt->home_assistant = std::move(prefix);
  return model;
}

/// The first connection, as its look finds these prefixes.
void connect_behind(PlantSite& site, const std::string& prefixes) {
  site.broker().events->on_connected({.id = 1, .broker = "10.0.0.1:1883"});
  site.loop().settle();
  site.broker().unanswered.clear();
  site.broker().events->on_subscribed({.filter = "canopen/line3/#"});
  site.receive({.topic = kMemory, .payload = prefixes, .retained = true});
  site.run(Session::kQuiet + 100ms);
  site.broker().events->on_unsubscribed("canopen/line3/#");
  site.loop().settle();
  site.broker().answer_subscriptions();
  site.loop().settle();
}

bool is_subscribed(PlantSite& site, const std::string& filter) {
  return std::ranges::any_of(site.broker().subscribed, [&](const Subscription& each) { return each.filter == filter; });
}

TEST(MqttHomeAssistant, IsToldOfEachDriveAtEveryConnection) {
  PlantSite site(model_with("homeassistant"));
  site.bring_up_drive();
  site.connect();
  EXPECT_TRUE(site.broker().on(kPumpConfig).empty()) << "what the broker keeps of before is still to come";
  site.run(Discovery::kPause + 50ms);
  const Message message = site.broker().newest(kPumpConfig);
  EXPECT_TRUE(message.retained);
  EXPECT_EQ(message.expiry, 0U);
  EXPECT_TRUE(contains(message.payload, R"("sensor_output_frequency":{)")) << message.payload;
  EXPECT_TRUE(contains(message.payload, R"("sw_version":"1.2.3")")) << message.payload;
  EXPECT_TRUE(contains(site.retained("info"), R"("home_assistant":"homeassistant")")) << site.retained("info");
  site.run(60s);
  EXPECT_EQ(site.broker().on(kPumpConfig).size(), 1U);
  site.broker().events->on_disconnected("gone");
  site.connect(2);
  site.run(Discovery::kPause + 50ms);
  EXPECT_EQ(site.broker().on(kPumpConfig), (std::vector<std::string>{message.payload, message.payload}));
}

TEST(MqttHomeAssistant, OffIsOff) {
  PlantSite site;
  site.bring_up_drive();
  site.connect();
  site.run(5s);
  for (const Message& message : site.broker().published) {
    EXPECT_TRUE(message.topic.starts_with("canopen/line3/")) << message.topic;
  }
  for (const Subscription& each : site.broker().subscribed) {
    EXPECT_TRUE(each.filter.starts_with("canopen/line3/")) << each.filter;
  }
  EXPECT_TRUE(contains(site.retained("info"), R"("home_assistant":null)")) << site.retained("info");
}

TEST(MqttHomeAssistant, EachDriveIsToldOf) {
  config::Model model = model_with("a/b");
  config::Drive second = model.drives[0];
  second.name = "pump2";
  second.node.node = 6;
  second.unit = std::uint8_t{6};
  second.enabled = false;
  model.drives.push_back(second);
  model.mqtt->base = "site 1/canopen";
  PlantSite site(std::move(model));
  site.connect();
  site.run(2s);
  EXPECT_TRUE(contains(site.broker().newest("a/b/device/site_1_canopen_line3/pump1/config").payload,
                       R"("name":"line3 pump1")"));
  EXPECT_TRUE(contains(site.broker().newest("a/b/device/site_1_canopen_line3/pump2/config").payload,
                       R"("name":"line3 pump2")"));
}

TEST(MqttHomeAssistant, IsToldAgainWhenItSaysThatItIsThere) {
  PlantSite site(model_with("homeassistant"));
  site.bring_up_drive();
  site.connect();
  EXPECT_TRUE(site.broker().subscription(kBirthTopic).watched);
  site.run(Discovery::kLeast + 2s);
  site.broker().forget();
  site.receive({.topic = kBirthTopic, .payload = "offline"}, 1s);
  EXPECT_TRUE(site.broker().on(kPumpConfig).empty());
  site.receive({.topic = kBirthTopic, .payload = "online"}, 100ms);
  EXPECT_EQ(site.broker().on(kPumpConfig).size(), 1U);
  for (int i = 0; i < 100; ++i) {
    site.receive({.topic = kBirthTopic, .payload = "online"}, 50ms);
  }
  EXPECT_EQ(site.broker().on(kPumpConfig).size(), 1U) << "5 s later";
  site.run(Discovery::kLeast);
  EXPECT_EQ(site.broker().on(kPumpConfig).size(), 2U);
  EXPECT_EQ(site.broker().dropped, 0U);
}

TEST(MqttHomeAssistant, ADriveThatIsGoneIsRemovedThere) {
  PlantSite site(model_with("homeassistant"));
  site.bring_up_drive();
  site.connect();
  EXPECT_TRUE(site.broker().subscription(kConfigFilter).kept);
  site.receive({.topic = kGoneConfig, .payload = kKeptConfig, .retained = true}, 2s);
  EXPECT_EQ(site.broker().newest(kGoneConfig), Message{.topic = kGoneConfig});
  EXPECT_TRUE(contains(site.broker().newest(kPumpConfig).payload, R"("name":"line3 pump1")"));
  ASSERT_FALSE(site.notices().empty());
  EXPECT_TRUE(contains(site.notices().back(), kGoneConfig)) << site.notices().back();
}

TEST(MqttHomeAssistant, WhatOthersPutThereStays) {
  PlantSite site(model_with("homeassistant"));
  site.bring_up_drive();
  site.connect();
  for (const char* payload : {R"({"availability":[{"topic":"canopen/line4/status"}]})", "{", "x", ""}) {
    site.receive({.topic = kGoneConfig, .payload = payload, .retained = true}, 1s);
  }
  site.receive({.topic = kGoneConfig, .payload = kKeptConfig}, 1s);
  EXPECT_TRUE(site.broker().on(kGoneConfig).empty()) << "and what is published there now is looked at the next time";
}

TEST(MqttHomeAssistant, AnEntityThatIsGoneIsRemovedWithTheFirstMessage) {
  PlantSite site(model_with("homeassistant"));
  site.bring_up_drive();
  site.connect();
  site.receive({.topic = kPumpConfig, .payload = kKeptConfig, .retained = true}, 5s);
  const std::vector<std::string> told = site.broker().on(kPumpConfig);
  ASSERT_EQ(told.size(), 1U) << "Home Assistant loses what comes while it is at work on the last one";
  EXPECT_TRUE(contains(told[0], R"("sensor_old":{"platform":"sensor"})")) << told[0];
  EXPECT_TRUE(contains(told[0], R"("sensor_output_frequency":{"platform":"sensor","unique_id")")) << told[0];
}

TEST(MqttHomeAssistant, OneThatIsHeardOfLateIsRemovedAllTheSame) {
  PlantSite site(model_with("homeassistant"));
  site.bring_up_drive();
  site.connect();
  site.run(5s);
  site.receive({.topic = kPumpConfig, .payload = kKeptConfig, .retained = true}, 2s);
  EXPECT_EQ(site.broker().on(kPumpConfig).size(), 2U);
  EXPECT_TRUE(contains(site.broker().newest(kPumpConfig).payload, R"("sensor_old":{"platform":"sensor"})"));
}

TEST(MqttHomeAssistant, SwitchedOffAllOfItIsEmptied) {
  PlantSite site;
  site.bring_up_drive();
  connect_behind(site, R"({"prefixes":["homeassistant"]})");
  EXPECT_TRUE(is_subscribed(site, kConfigFilter));
  EXPECT_FALSE(is_subscribed(site, kBirthTopic));
  site.receive({.topic = kPumpConfig, .payload = kKeptConfig, .retained = true}, 1s);
  EXPECT_EQ(site.broker().on(kPumpConfig), std::vector<std::string>{""});
}

TEST(MqttHomeAssistant, BelowAnotherPrefixThanBeforeTheOldOneIsEmptied) {
  PlantSite site(model_with("home"));
  site.bring_up_drive();
  connect_behind(site, R"({"prefixes":["homeassistant"]})");
  site.receive({.topic = kPumpConfig, .payload = kKeptConfig, .retained = true}, 2s);
  EXPECT_EQ(site.broker().on(kPumpConfig), std::vector<std::string>{""});
  EXPECT_TRUE(contains(site.broker().newest("home/device/canopen_line3/pump1/config").payload, "sensor_nmt"));
}

TEST(MqttHomeAssistant, WhatIsNoPrefixIsNotWatched) {
  for (const char* prefix : {"", "#", "a/+", "$SYS", "canopen", "canopen/line3", "a\\u0000b"}) {
    PlantSite site;
    connect_behind(site, std::string(R"({"prefixes":[")") + prefix + "\"]}");
    for (const Subscription& each : site.broker().subscribed) {
      EXPECT_TRUE(each.filter.starts_with("canopen/line3/") && !contains(each.filter, "/device/")) << each.filter;
    }
  }
}

constexpr const char* kHealthOfAnother = R"({"ts":"2026-01-02T03:04:05.678Z","instance":"ffff222233334444"})";

TEST(MqttHomeAssistant, WhereAnotherGatewayLivesNothingIsToldUntilItIsGone) {
  PlantSite site(model_with("homeassistant"));
  site.bring_up_drive();
  site.connect();
  site.receive({.topic = "canopen/line3/health", .payload = kHealthOfAnother}, 100ms);
  site.receive({.topic = kPumpConfig, .payload = kKeptConfig, .retained = true}, 5s);
  site.receive({.topic = kBirthTopic, .payload = "online"}, 5s);
  EXPECT_TRUE(site.broker().on(kPumpConfig).empty()) << "it may hold more than ours";
  site.run(181s);
  EXPECT_EQ(site.broker().on(kPumpConfig).size(), 1U);
}

TEST(MqttHomeAssistant, BehindALifeThatEndedWithoutAWordItIsToldWhenNobodyElseIsHeard) {
  PlantSite site(model_with("homeassistant"));
  site.bring_up_drive();
  site.broker().events->on_connected({.id = 1});
  site.loop().settle();
  site.broker().unanswered.clear();
  site.broker().events->on_subscribed({.filter = "canopen/line3/#"});
  site.receive({.topic = "canopen/line3/status", .payload = "online", .retained = true});
  site.run(Session::kQuiet + 100ms);
  site.broker().events->on_unsubscribed("canopen/line3/#");
  site.loop().settle();
  site.broker().answer_subscriptions();
  site.run(64s);
  EXPECT_TRUE(site.broker().on(kPumpConfig).empty());
  site.run(2s);
  EXPECT_EQ(site.broker().on(kPumpConfig).size(), 1U);
}

TEST(MqttHomeAssistant, WhatSomebodyElseWritesOfADriveIsPutRightAndNamed) {
  PlantSite site(model_with("homeassistant"));
  site.bring_up_drive();
  site.connect();
  site.run(Discovery::kLeast + 2s);
  const std::string ours = site.broker().newest(kPumpConfig).payload;
  site.broker().forget();
  site.receive({.topic = kPumpConfig, .payload = ours}, 15s);
  EXPECT_TRUE(site.broker().on(kPumpConfig).empty()) << "MQTT 3.1.1 sends back what is ours";
  const std::string others = R"({"components":{"button_stop":{"payload_press":"{\"value\":\"forward\"}"}}})";
  site.receive({.topic = kPumpConfig, .payload = others}, 100ms);
  EXPECT_EQ(site.broker().newest(kPumpConfig).payload, ours);
  EXPECT_TRUE(site.broker().newest(kPumpConfig).puts_right);
  ASSERT_FALSE(site.notices().empty());
  EXPECT_TRUE(contains(site.notices().back(), std::string("somebody else wrote on ") + kPumpConfig))
      << site.notices().back();
  for (int i = 0; i < 100; ++i) {
    site.receive({.topic = kPumpConfig, .payload = others}, 50ms);
  }
  EXPECT_EQ(site.broker().on(kPumpConfig).size(), 1U) << "5 s later";
  site.run(Discovery::kLeast);
  EXPECT_EQ(site.broker().on(kPumpConfig).size(), 2U);
  site.receive({.topic = kPumpConfig}, Discovery::kLeast);
  EXPECT_EQ(site.broker().on(kPumpConfig).size(), 3U) << "nor may it be taken away";
}

TEST(MqttHomeAssistant, WhatTheBrokerKeepsOfSomebodyElseOnATopicOfOursIsNamed) {
  PlantSite site(model_with("homeassistant"));
  site.bring_up_drive();
  site.connect();
  site.receive({.topic = kPumpConfig,
                .payload = R"({"availability":[{"topic":"canopen_line3/status"}],"components":{}})",
                .retained = true},
               2s);
  EXPECT_EQ(site.broker().on(kPumpConfig).size(), 1U);
  ASSERT_FALSE(site.notices().empty());
  EXPECT_TRUE(contains(site.notices().back(), kPumpConfig)) << site.notices().back();
}

TEST(MqttHomeAssistant, AStartInTheMidstOfTellingCountsForThoseToldBefore) {
  PlantSite site(model_with("homeassistant"));
  site.bring_up_drive();
  site.connect();
  site.run(Discovery::kPause + 50ms);
  site.receive({.topic = kBirthTopic, .payload = "online"}, 5s);
  EXPECT_EQ(site.broker().on(kPumpConfig).size(), 1U);
  site.run(Discovery::kLeast);
  EXPECT_EQ(site.broker().on(kPumpConfig).size(), 2U);
}

TEST(MqttHomeAssistant, WhereAnotherGatewayLivesNothingIsRemoved) {
  PlantSite site(model_with("homeassistant"));
  site.bring_up_drive();
  site.connect();
  site.receive({.topic = "canopen/line3/health", .payload = kHealthOfAnother}, 100ms);
  site.receive({.topic = kGoneConfig, .payload = kKeptConfig, .retained = true}, 5s);
  EXPECT_TRUE(site.broker().on(kGoneConfig).empty());
}

TEST(MqttHomeAssistant, WhereItMayNotBeReadTheLogSaysWhatIsMissing) {
  PlantSite site(model_with("homeassistant"));
  site.broker().events->on_connected({.id = 1});
  site.loop().settle();
  site.broker().answer_subscriptions("Not authorized (0x87)", kBirthTopic);
  site.loop().settle();
  EXPECT_TRUE(site.bridge().connected());
  ASSERT_FALSE(site.notices().empty());
  EXPECT_TRUE(contains(site.notices().back(), "Home Assistant is not told of the drives again when it starts"))
      << site.notices().back();
}

}  // namespace
}  // namespace mqtt
