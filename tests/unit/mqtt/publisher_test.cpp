#include "bridges/mqtt/publisher.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <future>
#include <string>

#include "bridges/mqtt/loop_post.h"
#include "tests/support/mosquitto.h"
#include "tests/unit/mqtt/publisher_fixture.h"
#include "tests/unit/mqtt/tiny_broker.h"

namespace mqtt {
namespace {

using namespace std::chrono_literals;
using test::TinyBroker;

class MqttPublisher : public test::PublisherFixture {
 protected:
  [[nodiscard]] bool is_said(const std::string& text) const {
    return std::ranges::any_of(notices, [&](const std::string& each) { return each.find(text) != std::string::npos; });
  }
};

TEST_F(MqttPublisher, FallsBackTo311WhereTheBrokerHasNo5) {
  TinyBroker broker({});
  make(settings(broker.port()));
  ASSERT_TRUE(connected());
  EXPECT_EQ(broker.levels(), (std::vector<int>{5, 4}));
  ASSERT_EQ(notices.size(), 1U);
  EXPECT_NE(notices[0].find("MQTT 3.1.1"), std::string::npos) << notices[0];
  ASSERT_TRUE(subscribe({{"canopen/line3/+/set", 1}}));
  EXPECT_TRUE(grants[0]);
  publisher->publish({{.topic = "a", .payload = "1"}});
  publisher->open(connections.back());
  ASSERT_TRUE(run_until([&broker] { return !broker.published().empty(); }));
  const auto took = stop({{.topic = "canopen/line3/status", .payload = "offline"}});
  EXPECT_LT(took, 3s);
  EXPECT_EQ(broker.published(), (std::vector<std::string>{"a=1", "canopen/line3/status=offline"}));
}

TEST_F(MqttPublisher, AStopIsNotLostInAFlood) {
  constexpr std::size_t kLost = 500;
  TinyBroker broker({.flood = LoopPost::kMaxMessages + kLost});
  auto taken = broker.flood_taken();
  make(settings(broker.port()));
  ASSERT_TRUE(connected());
  publisher->subscribe(connections.back(), {{"x", 1}});
  ASSERT_EQ(taken.wait_for(20s), std::future_status::ready) << "while the loop stands still";
  ASSERT_TRUE(run_until([this] { return !messages.empty() && messages.back().payload == "stop"; }));
  EXPECT_EQ(messages.size(), LoopPost::kMaxMessages + 1);
  EXPECT_TRUE(std::ranges::any_of(notices, [](const std::string& notice) {
    return notice.find(std::to_string(kLost) + " commands") != std::string::npos;
  }));
}

TEST_F(MqttPublisher, SendsNothingBeforeItIsOpened) {
  TinyBroker broker({.speaks_5 = false});
  make(settings(broker.port()));
  publisher->publish({{.topic = "early", .payload = "1"}});
  publisher->publish({{.topic = "early", .payload = "2"}});
  ASSERT_TRUE(connected());
  ASSERT_TRUE(subscribe({{"x", 0}}));
  EXPECT_TRUE(broker.published().empty());
  publisher->open(connections.back() + 1);  // of another connection
  ASSERT_TRUE(subscribe({{"y", 0}}));
  EXPECT_TRUE(broker.published().empty());
  publisher->open(connections.back());
  ASSERT_TRUE(run_until([&broker] { return !broker.published().empty(); }));
  EXPECT_EQ(broker.published(), std::vector<std::string>{"early=2"});
}

TEST_F(MqttPublisher, ABrokerThatRefusesIsToldOnceAndTriedAgain) {
  TinyBroker broker({.speaks_5 = false, .mute = false, .refusal = 5});
  make(settings(broker.port()));
  ASSERT_TRUE(run_until([&broker] { return broker.levels().size() >= 6; }));
  ASSERT_EQ(notices.size(), 1U);
  EXPECT_NE(notices[0].find("ot authorized"), std::string::npos) << notices[0];
  EXPECT_TRUE(connections.empty());
}

TEST_F(MqttPublisher, BreaksWithoutAWordSoonAfterConnectingNameTheSuspicion) {
  const std::string suspicion = "perhaps another client has the client id canopen-gateway-line3";
  TinyBroker broker({.speaks_5 = true, .closes_on_subscribe = true});
  make(settings(broker.port()));
  ASSERT_TRUE(connected());
  publisher->subscribe(connections.back(), {{"x", 1}});
  ASSERT_TRUE(connected(2));
  EXPECT_TRUE(is_said("the connection broke; trying again"));
  EXPECT_FALSE(is_said(suspicion)) << "once may be chance";
  publisher->subscribe(connections.back(), {{"x", 1}});
  ASSERT_TRUE(connected(3));
  EXPECT_TRUE(run_until([&] { return is_said(suspicion); }));
  EXPECT_EQ(take_overs, 0U) << "it is no more than a suspicion";
}

TEST_F(MqttPublisher, ABrokerThatSaysWhyItEndsConnectionsIsNotSuspectedOfATakeOver) {
  TinyBroker broker({.speaks_5 = true});
  make(settings(broker.port()));
  for (std::size_t times = 1; times <= 3; ++times) {
    ASSERT_TRUE(connected(times));
    broker.disconnect(0x81);
    ASSERT_TRUE(run_until([&] { return disconnections == times; }));
  }
  ASSERT_TRUE(connected(4));
  EXPECT_TRUE(is_said("(0x81)"));
  EXPECT_FALSE(is_said("perhaps another client"));
}

TEST_F(MqttPublisher, ABrokerThatSaysNothingHoldsUpNeitherLoopNorEnd) {
  TinyBroker broker({.speaks_5 = true, .mute = true});
  make(settings(broker.port()));
  ASSERT_TRUE(run_until([&broker] { return !broker.levels().empty(); }));
  publisher->publish({{.topic = "a", .payload = "1"}});
  EXPECT_LT(stop({{.topic = "a", .payload = "2"}}), 3s);
  EXPECT_TRUE(connections.empty());
}

TEST_F(MqttPublisher, ANameThatDoesNotResolveHoldsUpNeitherLoopNorEnd) {
  std::promise<void> release;
  std::promise<void> ended;
  PublisherSettings made = settings(1);
  std::atomic<bool> asked = false;
  made.resolver = [&asked, released = release.get_future().share()](const config::Endpoint&) {
    asked = true;
    released.wait();
    return std::vector<std::string>{};
  };
  make(std::move(made));
  ASSERT_TRUE(run_until([&asked] { return asked.load(); }));
  publisher->publish({{.topic = "a", .payload = "1"}});
  EXPECT_LT(stop(), 6s) << "although name resolution still hangs";
  EXPECT_TRUE(publisher->ended()) << "it has a thread of its own";
  release.set_value();
}

TEST_F(MqttPublisher, TriesEveryAddressOfAName) {
  TinyBroker broker({});
  PublisherSettings made = settings(broker.port());
  made.brokers.front().host = "broker.example";
  made.resolver = [](const config::Endpoint&) { return std::vector<std::string>{"127.0.0.2", "127.0.0.1"}; };
  make(std::move(made));
  EXPECT_TRUE(connected());
}

TEST_F(MqttPublisher, ANameWithoutAddressIsSaid) {
  PublisherSettings made = settings(1);
  made.resolver = [](const config::Endpoint&) { return std::vector<std::string>{}; };
  make(std::move(made));
  ASSERT_TRUE(run_until([this] { return !notices.empty(); }));
  EXPECT_NE(notices[0].find("has no address"), std::string::npos) << notices[0];
  EXPECT_LT(stop(), 2s);
}

TEST_F(MqttPublisher, ResolvesNumericAddresses) {
  EXPECT_EQ(resolve({"127.0.0.1", 1883}), std::vector<std::string>{"127.0.0.1"});
  EXPECT_EQ(resolve({"::1", 1883}), std::vector<std::string>{"::1"});
}

TEST_F(MqttPublisher, EndsWithoutEverHavingBeenStopped) {
  TinyBroker broker({});
  make(settings(broker.port()));
  ASSERT_TRUE(connected());
  publisher.reset();
  context.poll();
  EXPECT_EQ(disconnections, 0U) << "nothing arrives any more";
}

}  // namespace
}  // namespace mqtt
