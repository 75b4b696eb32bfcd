// What the broker holds is true, also when the gateway is gone or somebody else wrote there.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "bridges/mqtt/bridge.h"
#include "bridges/mqtt/payload.h"
#include "bridges/mqtt/publisher.h"
#include "tests/unit/mqtt/plant_site.h"

namespace mqtt {
namespace {

using namespace std::chrono_literals;
using test::contains;
using test::PlantSite;

constexpr const char* kStatus = "canopen/line3/status";
constexpr const char* kPumpStatus = "canopen/line3/pump1/status";
constexpr const char* kState = "canopen/line3/pump1/state";
constexpr const char* kFrequency = "canopen/line3/pump1/output_frequency";
constexpr const char* kHealth = "canopen/line3/health";

config::Model model_with(canopen::Duration expiry, const std::string& stale_payload = {}) {
  config::Model model = PlantSite::bridge_model();
  model.mqtt->expiry = expiry;
  model.mqtt->stale_payload = stale_payload;
  return model;
}

void lose_values(PlantSite& site) {
  for (std::uint8_t sub = 1; sub <= 4; ++sub) {
    site.puppet().dictionary.erase({0x2021, sub});  // else SDO reads take the place of the TPDO
  }
  site.run_silent(2s);
}

TEST(MqttTruth, WhatIsLiveExpiresAndTheRestDoesNot) {
  PlantSite site(model_with(90s));
  site.bring_up_drive();
  site.connect();
  for (const char* topic : {kStatus, kPumpStatus, kState, kFrequency, kHealth}) {
    EXPECT_EQ(site.broker().newest(topic).expiry, 90U) << topic;
  }
  for (const char* topic : {"info", "alarms", "pump1/control", "pump1/alarm/emcy", "bus/can0/alarm"}) {
    EXPECT_EQ(site.broker().newest("canopen/line3/" + std::string(topic)).expiry, 0U) << topic;
  }
  lose_values(site);
  EXPECT_EQ(site.broker().newest(kFrequency), (Message{.topic = kFrequency, .payload = ""})) << "stands for ever";
  EXPECT_EQ(site.broker().newest(kState).expiry, 90U);
  site.puppet().mute = true;
  site.loop().advance(5s, 10ms);
  EXPECT_EQ(site.broker().newest(kPumpStatus),
            (Message{.topic = kPumpStatus, .payload = "offline", .kind = MessageKind::status}));
}

TEST(MqttTruth, WhatIsLiveIsToldAgainAtAThirdOfItsExpiry) {
  PlantSite site(model_with(30s));
  site.bring_up_drive();
  site.connect();
  site.run(500ms);
  site.broker().forget();
  site.run(9s);
  for (const char* topic : {kStatus, kPumpStatus, kState, kFrequency}) {
    EXPECT_TRUE(site.broker().on(topic).empty()) << topic;
  }
  site.run(51s);  // 60 s in all: six times 10 s
  for (const char* topic : {kStatus, kPumpStatus, kState, kFrequency}) {
    EXPECT_GE(site.broker().on(topic).size(), 5U) << topic;
    EXPECT_LE(site.broker().on(topic).size(), 6U) << topic;
  }
  EXPECT_GE(site.broker().on(kHealth).size(), 5U);
}

TEST(MqttTruth, ForEverIsAskedForByZero) {
  PlantSite site(model_with(0s));
  site.bring_up_drive();
  site.connect();
  EXPECT_TRUE(std::all_of(site.broker().published.begin(), site.broker().published.end(),
                          [](const Message& message) { return message.expiry == 0; }));
  site.broker().forget();
  site.run(125s);
  EXPECT_TRUE(site.broker().on(kStatus).empty());
  EXPECT_EQ(site.broker().on(kFrequency).size(), 2U) << "every longest interval";
}

TEST(MqttTruth, EachMessageIsOfItsKind) {
  PlantSite site;
  site.bring_up_drive();
  site.connect();
  site.command("pump1/frequency_command/set", "10");
  for (const Message& message : site.broker().published) {
    MessageKind kind = MessageKind::value;
    if (message.topic.ends_with("/status")) {
      kind = MessageKind::status;
    } else if (contains(message.topic, "/alarm")) {
      kind = MessageKind::alarm;
    } else if (message.topic.ends_with("/result")) {
      kind = MessageKind::answer;
    }
    EXPECT_EQ(message.kind, kind) << message.topic;
    EXPECT_EQ(message.after_all, message.topic == kStatus) << message.topic;
  }
}

TEST(MqttTruth, AStalePayloadStandsInPlaceOfNothing) {
  PlantSite site(model_with(90s, "stale"));
  site.bring_up_drive();
  site.send_values(0x0001, 3000, 4);
  site.connect();
  EXPECT_EQ(site.retained("pump1/output_frequency"), "30.00");
  lose_values(site);
  EXPECT_EQ(site.retained("pump1/output_frequency"), "stale");
  EXPECT_EQ(site.retained("pump1/running"), "stale");
  EXPECT_TRUE(contains(site.retained("pump1/state"), R"("output_frequency":null)")) << "only on plain topics";
}

TEST(MqttTruth, AnOrderlyEndLeavesNothingThatLooksLive) {
  PlantSite site(model_with(90s, "gone"));
  site.bring_up_drive();
  site.connect();
  site.stop_bridge();
  const std::vector<Message>& last = site.broker().last_words;
  const auto said = [&last](const std::string& topic) {
    std::vector<Message> found;
    std::copy_if(last.begin(), last.end(), std::back_inserter(found),
                 [&topic](const Message& message) { return message.topic == topic; });
    return found.empty() ? Message{} : found.back();
  };
  const Message state = said(kState);
  EXPECT_TRUE(contains(state.payload, R"("online":false,"nmt":"unknown","fresh":false,"values":{"status_word":null,)"
                                      R"("output_frequency":null,)"))
      << state.payload;
  EXPECT_TRUE(contains(state.payload, R"("mode":null,"mode_code":null,"brake":null}})")) << state.payload;
  EXPECT_EQ(said(kFrequency).payload, "gone");
  EXPECT_EQ(said("canopen/line3/pump1/mode").payload, "gone");
  EXPECT_EQ(said("canopen/line3/pump1/frequency_command").topic, "") << "never was there";
  for (const Message& message : last) {
    EXPECT_EQ(message.expiry, 0U) << message.topic;
    EXPECT_TRUE(message.retained) << message.topic;
  }
  ASSERT_GE(last.size(), 2U);
  EXPECT_EQ(last[last.size() - 2].topic, kPumpStatus);
  EXPECT_EQ(last[last.size() - 2].payload, "offline");
  EXPECT_EQ(last.back().topic, kStatus);
  EXPECT_EQ(last.back().payload, "offline");
}

TEST(MqttTruth, AStatusThatSomebodyOverwritesIsPutRightAtMostOnceASecond) {
  PlantSite site;
  site.bring_up_drive();
  site.connect();
  site.run(1s);
  for (const char* topic : {kStatus, kPumpStatus}) {
    site.broker().forget();
    for (int i = 0; i < 20; ++i) {
      site.receive({.topic = topic, .payload = i % 2 == 0 ? "offline" : ""}, 50ms);
    }
    for (const std::string& payload : site.broker().on(topic)) {
      EXPECT_EQ(payload, "online");
    }
    EXPECT_GE(site.broker().on(topic).size(), 1U) << topic;
    EXPECT_LE(site.broker().on(topic).size(), 2U) << topic;
    site.run(1s);
    EXPECT_EQ(site.broker().newest(topic).payload, "online");
    site.broker().forget();
    site.run(3s);
    EXPECT_TRUE(site.broker().on(topic).empty()) << "and then it is quiet";
  }
}

TEST(MqttTruth, WhatTheBrokerKeptOrSendsBackIsNoOverwriting) {
  PlantSite site;
  site.bring_up_drive();
  site.connect();
  site.run(1s);
  site.broker().forget();
  site.receive({.topic = kStatus, .payload = "offline", .retained = true});
  site.receive({.topic = kPumpStatus, .payload = "offline", .retained = true});
  site.receive({.topic = kStatus, .payload = "online"});
  site.receive({.topic = kPumpStatus, .payload = "online"});
  site.receive({.topic = "canopen/line3/nobody/status", .payload = "online"});
  site.run(2s);
  EXPECT_TRUE(site.broker().published.empty()) << site.broker().published.front().topic;
}

TEST(MqttTruth, TheTimeOfTheStateIsThatOfTheNewestValueWhateverTheTimeOfDayDid) {
  const canopen::WallTime before = canopen::WallTime{} + 100h;
  const canopen::WallTime set_back = canopen::WallTime{} + 1h;
  std::array<process::SourceState, 3> sources{};
  EXPECT_EQ(newest_value(sources), std::nullopt);
  sources[0] = {.source = {}, .received = true, .at = canopen::TimePoint{10s}, .wall = before};
  sources[1] = {.source = {}, .received = true, .at = canopen::TimePoint{20s}, .wall = set_back};
  EXPECT_EQ(newest_value(sources), set_back);
  sources[2] = {.source = {}, .received = false, .at = canopen::TimePoint{30s}, .wall = before};
  EXPECT_EQ(newest_value(sources), before) << "received before the drive was lost";
}

TEST(MqttTruth, HealthTellsOfTheGatewayAndItsConnection) {
  PlantSite site;
  site.bridge().tell_program_health_by([] {
    return process::ProgramHealth{
        .uptime = 90500ms, .memory = 12345678, .log_lost = 3, .journal = "ab12", .clock_set = true};
  });
  site.bring_up_drive();
  site.broker().counted = {.messages_dropped = 4, .answers_dropped = 5};
  site.broker().events->on_connected({.id = 1, .version = 4, .broker = "10.0.0.1:1883"});
  site.broker().answer_subscriptions("no", "canopen/line3/stop");
  site.loop().settle();
  const std::string health = site.retained("health");
  EXPECT_TRUE(contains(health, R"({"ts":"2026-01-02T03:04:)")) << health;
  EXPECT_TRUE(contains(health, R"("uptime":90,"buses":[{"name":"can0","state":"active","load":0.015}],)"
                               R"("drives":1,"drives_online":1,"broker":"10.0.0.1:1883","protocol":"3.1.1",)"
                               R"("refused_subscriptions":["canopen/line3/stop"],"last_break":null,)"
                               R"("another_instance":null,"put_right":0,)"
                               R"("messages_dropped":4,"answers_dropped":5,"log_messages_lost":3,)"
                               R"("memory":12345678,"journal":"ab12"})"))
      << health;
}

TEST(MqttTruth, HealthIsToldAtAChangeAtMostOnceASecond) {
  std::uint64_t lost = 0;
  std::uint64_t memory = 0;
  PlantSite site;
  site.bridge().tell_program_health_by([&] { return process::ProgramHealth{.memory = ++memory, .log_lost = lost}; });
  site.bring_up_drive();
  site.connect();
  site.run(2s);
  site.broker().forget();
  site.run(20s);
  EXPECT_TRUE(site.broker().on(kHealth).empty()) << "memory and loads alone are no news";
  for (int i = 0; i < 40; ++i) {
    ++lost;
    site.run(50ms);
  }
  EXPECT_GE(site.broker().on(kHealth).size(), 1U);
  EXPECT_LE(site.broker().on(kHealth).size(), 3U);
  site.run(1s);
  EXPECT_TRUE(contains(site.retained("health"), R"("log_messages_lost":40)")) << site.retained("health");
}

TEST(MqttTruth, HealthTellsWhyTheLastConnectionEnded) {
  PlantSite site;
  site.connect();
  EXPECT_TRUE(contains(site.retained("health"), R"("last_break":null)"));
  site.broker().events->on_disconnected("the broker says session taken over, 0x8E");
  site.connect(2);
  EXPECT_TRUE(contains(site.retained("health"), R"("last_break":"the broker says session taken over, 0x8E")"))
      << site.retained("health");
  site.broker().events->on_disconnected("gone");
  site.broker().events->on_no_connection("TLS: the broker's certificate has expired");
  site.connect(3);
  EXPECT_TRUE(contains(site.retained("health"), R"("last_break":"TLS: the broker's certificate has expired")"))
      << site.retained("health");
}

TEST(MqttSettings, NameTheClientAndTheVersion) {
  config::Mqtt mqtt;
  const config::Gateway gateway{.name = "line3"};
  EXPECT_EQ(publisher_settings(mqtt, gateway).client.client_id, "canopen-gateway-line3");
  EXPECT_EQ(publisher_settings(mqtt, gateway).version, 0) << "whatever the broker speaks";
  mqtt.client_id = "other";
  mqtt.version = config::MqttVersion::v5;
  EXPECT_EQ(publisher_settings(mqtt, gateway).client.client_id, "other");
  EXPECT_EQ(publisher_settings(mqtt, gateway).version, 5);
  mqtt.version = config::MqttVersion::v3_1_1;
  EXPECT_EQ(publisher_settings(mqtt, gateway).version, 4);
}

TEST(MqttSettings, NameTheFiles) {
  config::Mqtt mqtt;
  mqtt.brokers = {{"broker.example", 8883, true}};
  mqtt.password_file = "/p";
  mqtt.ca_file = "/ca";
  mqtt.cert_file = "/cert";
  mqtt.key_file = "/key";
  const PublisherSettings settings = publisher_settings(mqtt, {.name = "line3"});
  EXPECT_TRUE(settings.brokers.front().tls);
  EXPECT_EQ(settings.password_file, "/p");
  EXPECT_EQ(settings.client.tls.ca, "/ca");
  EXPECT_EQ(settings.client.tls.cert, "/cert");
  EXPECT_EQ(settings.client.tls.key, "/key");
}

TEST(TruthTest, NothingIsAnnouncedBehindTheLastWords) {
  test::PlantSite site;
  site.bring_up_drive();
  test::FakeBroker& broker = site.broker();
  broker.events->on_connected({.id = 1});  // the end comes before the broker has answered
  broker.while_stopping = [&broker] { broker.answer_subscriptions(); };
  site.stop_bridge();
  ASSERT_TRUE(broker.stopped);
  EXPECT_EQ(broker.last_words.back().payload, "offline");
  EXPECT_EQ(broker.on("canopen/line3/status"), std::vector<std::string>{});
  EXPECT_EQ(broker.opened, ConnectionId{0});
}

TEST(TruthTest, WhatNobodyHeardBeforeALateSubscriptionIsSaidAgain) {
  test::PlantSite site;
  site.bring_up_drive();
  site.connect();
  site.run(100ms);
  site.broker().forget();
  site.broker().events->on_subscribed({.filter = "canopen/line3/alarms", .refused = "Not authorized (0x87)"});
  site.run(100ms);
  EXPECT_TRUE(site.broker().on("canopen/line3/alarms").empty());
  site.broker().events->on_subscribed({.filter = "canopen/line3/alarms"});
  site.run(100ms);
  EXPECT_EQ(site.broker().on("canopen/line3/alarms").size(), 1U);
  EXPECT_EQ(site.broker().on("canopen/line3/status"), std::vector<std::string>{"online"});
  EXPECT_EQ(site.broker().on("canopen/line3/pump1/status"), std::vector<std::string>{"online"});
}

}  // namespace
}  // namespace mqtt
