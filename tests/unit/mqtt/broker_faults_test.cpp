// Brokers that close, refuse, hurry away or are slow: what is noticed, what is said, and what still arrives.

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <future>
#include <string>

#include "tests/support/mosquitto.h"
#include "tests/unit/mqtt/publisher_fixture.h"
#include "tests/unit/mqtt/tiny_broker.h"

namespace mqtt {
namespace {

using namespace std::chrono_literals;
using test::TinyBroker;

class BrokerFaults : public test::PublisherFixture {
 protected:
  void open() { publisher->open(connections.back()); }
  [[nodiscard]] bool is_said(const std::string& text) const {
    return std::ranges::any_of(notices, [&](const std::string& each) { return each.find(text) != std::string::npos; });
  }
  static bool has(const TinyBroker& broker, const std::string& text) {
    const auto published = broker.published();
    return std::ranges::find(published, text) != published.end();
  }
  static Message answer(std::string topic, std::string payload) {
    return {.topic = std::move(topic), .payload = std::move(payload), .kind = MessageKind::answer, .retained = false};
  }
};

class Disconnects : public BrokerFaults, public testing::WithParamInterface<std::pair<int, const char*>> {};

TEST_P(Disconnects, AreNoticedAtOnceAndNamed) {
  TinyBroker broker({.speaks_5 = true});
  make(settings(broker.port()));
  ASSERT_TRUE(connected());
  open();
  publisher->publish({{.topic = "a", .payload = "1"}});
  ASSERT_TRUE(run_until([&] { return has(broker, "a=1"); }));
  broker.disconnect(GetParam().first);  // while nothing is under way
  const auto begun = Clock::now();
  ASSERT_TRUE(run_until([this] { return disconnections == 1; }));
  EXPECT_LT(Clock::now() - begun, 1s);
  EXPECT_NE(reasons.at(0).find(GetParam().second), std::string::npos) << reasons[0];
  EXPECT_TRUE(run_until([this] { return is_said(GetParam().second); }));
  EXPECT_TRUE(connected(2));
}

INSTANTIATE_TEST_SUITE_P(Codes, Disconnects,
                         testing::Values(std::pair(0x8E, "Session taken over (0x8E)"),
                                         std::pair(0x8B, "Server shutting down (0x8B)")));

TEST_F(BrokerFaults, AfterATakeOverItComesBackLate) {
  TinyBroker broker({.speaks_5 = true});
  PublisherSettings made = settings(broker.port());
  made.pause_after_refusal = 1500ms;
  make(std::move(made));
  ASSERT_TRUE(connected());
  broker.disconnect(0x8E);
  ASSERT_TRUE(run_until([this] { return disconnections == 1; }));
  const auto begun = Clock::now();
  ASSERT_TRUE(connected(2));
  EXPECT_GE(Clock::now() - begun, 1400ms);
  EXPECT_TRUE(is_said("another client has the client id canopen-gateway-line3"));
  broker.disconnect(0x8B);
  const auto again = Clock::now();
  ASSERT_TRUE(connected(3));
  EXPECT_LT(Clock::now() - again, 1400ms) << "only after a take-over";
  EXPECT_EQ(take_overs, 1U);
}

TEST_F(BrokerFaults, AnAnswerThatTheBrokerClosesOnIsTriedOnceMoreAtMost) {
  TinyBroker broker({.speaks_5 = true, .hates = "poison"});
  make(settings(broker.port()));
  ASSERT_TRUE(connected());
  open();
  publisher->publish({answer("poison", "x"), {.topic = "v", .payload = "1"}});
  std::size_t opened = 1;
  ASSERT_TRUE(run_until([&] {
    if (connections.size() > opened) {  // as the bridge does: everything again
      opened = connections.size();
      publisher->publish({{.topic = "v", .payload = "1"}});
      open();
    }
    return has(broker, "v=1");
  }));
  EXPECT_TRUE(run_until([this] { return publisher->counts().answers_dropped == 1; }));
  EXPECT_LE(connections.size(), 3U);
  publisher->publish({answer("fine", "y")});
  EXPECT_TRUE(run_until([&] { return has(broker, "fine=y"); })) << "and everything goes on";
  EXPECT_TRUE(is_said("answers dropped"));
}

TEST_F(BrokerFaults, ATopicThatTheBrokerClosesOnIsHeldBackAndAllElseIsPublished) {
  constexpr std::size_t kTopics = 40;
  TinyBroker broker({.speaks_5 = true, .hates = "t20"});
  make(settings(broker.port()));
  std::size_t opened = 0;
  ASSERT_TRUE(run_until([&] {
    if (connections.size() > opened) {  // as the bridge does: everything again
      opened = connections.size();
      std::vector<Message> batch;
      for (std::size_t i = 0; i < kTopics; ++i) {
        batch.push_back({.topic = "t" + std::to_string(i), .payload = "1"});
      }
      batch.push_back(
          {.topic = "status", .payload = "online", .kind = MessageKind::status, .retained = true, .after_all = true});
      publisher->publish(std::move(batch));
      open();
    }
    return has(broker, "status=online");
  }));
  EXPECT_LE(connections.size(), 3U);
  for (std::size_t i = 0; i < kTopics; ++i) {
    EXPECT_EQ(has(broker, "t" + std::to_string(i) + "=1"), i != 20) << i;
  }
  EXPECT_EQ(publisher->counts().messages_dropped, 1U);
  EXPECT_TRUE(is_said("where t20 is published"));
  publisher->publish({{.topic = "t20", .payload = "1"}, {.topic = "t21", .payload = "2"}});
  ASSERT_TRUE(run_until([&] { return has(broker, "t21=2"); }));
  EXPECT_EQ(disconnections, connections.size() - 1) << "the last one stands";
}

TEST_F(BrokerFaults, ABrokerThatClosesOnMqtt5IsAskedFor311TheSecondTime) {
  TinyBroker broker({.closes_on_5 = true});
  make(settings(broker.port()));
  ASSERT_TRUE(connected());
  EXPECT_EQ(broker.levels(), (std::vector<int>{5, 5, 4}));
  EXPECT_TRUE(is_said("closed before the broker answers"));
  EXPECT_TRUE(is_said("MQTT 3.1.1"));
}

TEST_F(BrokerFaults, AVersionThatIsConfiguredIsTheOnlyOne) {
  TinyBroker broker({.closes_on_5 = true});
  PublisherSettings made = settings(broker.port());
  made.version = 5;
  make(made);
  ASSERT_TRUE(run_until([&broker] { return broker.levels().size() >= 4; }));
  EXPECT_TRUE(std::ranges::all_of(broker.levels(), [](int level) { return level == 5; }));
  publisher.reset();
  TinyBroker other({});
  made = settings(other.port());
  made.version = 4;
  make(made);
  ASSERT_TRUE(connected());
  EXPECT_EQ(other.levels(), std::vector<int>{4});
}

// The broker takes a message each 20 ms, one after the other, and all values change each 40 ms: time is the number of
// messages that it has taken.
TEST_F(BrokerFaults, ASlowBrokerGetsAlarmsAndAnswersAtOnceAndNoOldValue) {
  TinyBroker broker({.speaks_5 = true, .by_hand = true});
  make(settings(broker.port()));
  ASSERT_TRUE(connected());
  open();
  constexpr std::size_t kSecond = 50;
  constexpr std::size_t kTopics = 50;
  constexpr std::size_t kRaised = 3 * kSecond;
  for (std::size_t taken = 0; taken < 5 * kSecond; ++taken) {
    std::vector<Message> batch;
    for (std::size_t i = 0; taken % 2 == 0 && i < kTopics; ++i) {
      batch.push_back({.topic = "v" + std::to_string(i), .payload = std::to_string(taken)});
    }
    if (taken == kRaised) {
      batch.push_back({.topic = "alarm", .payload = "on", .kind = MessageKind::alarm});
      batch.push_back(answer("reply", "ok"));
    }
    publisher->publish(std::move(batch));
    ASSERT_TRUE(broker.take_one());
  }
  const auto published = broker.published();
  for (const char* const urgent : {"alarm=on", "reply=ok"}) {
    const auto found = std::ranges::find(published, urgent);
    ASSERT_NE(found, published.end()) << urgent;
    EXPECT_LT(static_cast<std::size_t>(found - published.begin()), kRaised + kSecond) << urgent;
  }
  for (std::size_t i = 0; i < published.size(); ++i) {
    if (published[i].starts_with('v')) {
      const std::size_t written = std::stoul(published[i].substr(published[i].find('=') + 1));
      EXPECT_LT(i, written + 2 * kSecond) << published[i];
    }
  }
}

TEST_F(BrokerFaults, AThreadThatHangsIsNotAlive) {
  std::promise<void> release;
  PublisherSettings made = settings(1);
  made.resolve_patience = 200ms;
  made.resolver = [released = release.get_future().share()](const config::Endpoint&) {
    released.wait();
    return std::vector<std::string>{};
  };
  make(std::move(made));
  EXPECT_TRUE(publisher->alive());
  EXPECT_TRUE(run_until([this] { return !publisher->alive(); }));
  release.set_value();
  EXPECT_TRUE(run_until([this] { return publisher->alive(); }));
}

/// Hears that its connection stands, and holds Paho's lock, under which it is told, until it is released.
class HoldsPaho final : public ClientEvents {
 public:
  void on_up(BrokerLimits /*limits*/) noexcept override {
    if (!told_.exchange(true)) {
      holds_.set_value();
    }
    released_.wait();
  }
  void on_refused(Refusal /*refusal*/) noexcept override {}
  void on_down(int /*code*/) noexcept override {}
  void on_incoming(Incoming&& /*message*/) noexcept override {}
  void on_sent(const Message* /*message*/, Delivery /*delivery*/, int /*code*/) noexcept override {}
  void on_subscribed(Subscribed&& /*subscribed*/) noexcept override {}
  void on_unsubscribed(const std::string& /*filter*/) noexcept override {}

  [[nodiscard]] bool holds() { return held_.wait_for(10s) == std::future_status::ready; }
  void release() { release_.set_value(); }

 private:
  std::atomic<bool> told_ = false;
  std::promise<void> holds_;
  std::future<void> held_ = holds_.get_future();
  std::promise<void> release_;
  std::shared_future<void> released_ = release_.get_future().share();
};

TEST_F(BrokerFaults, AThreadThatHangsInAPublishIsNotAlive) {
  support::Mosquitto broker;
  ASSERT_TRUE(broker.start());
  PublisherSettings made = settings(broker.port());
  made.silence = 2500ms;
  HoldsPaho holder;
  ClientSettings another = made.client;
  another.uri = "tcp://127.0.0.1:" + std::to_string(broker.port());
  another.client_id = "another";
  make(std::move(made));
  ASSERT_TRUE(connected());
  publisher->open(connections.back());
  EXPECT_FALSE(run_until([this] { return !publisher->alive(); }, 4s)) << "with nothing to do it lives";
  Client client(another, holder);
  ASSERT_TRUE(client.connect());
  ASSERT_TRUE(holder.holds());
  publisher->publish({{.topic = "a", .payload = "1"}, {.topic = "b", .payload = "1"}});
  EXPECT_TRUE(run_until([this] { return !publisher->alive(); }, 10s));
  holder.release();
  EXPECT_TRUE(run_until([this] { return publisher->alive(); }, 10s));
}

// Paho holds its lock while it looks up the name of a broker with TLS, too.
TEST_F(BrokerFaults, AnEndIsNotHeldUpByAClientThatCannotBeDestroyed) {
  support::Mosquitto broker;
  ASSERT_TRUE(broker.start());
  const test::TinyBroker mute({.mute = true});
  PublisherSettings made = settings(mute.port());
  made.farewell = 100ms;
  ClientSettings another = made.client;
  another.uri = "tcp://127.0.0.1:" + std::to_string(broker.port());
  another.client_id = "another";
  HoldsPaho holder;
  make(std::move(made));
  EXPECT_FALSE(run_until([this] { return !connections.empty(); }, 500ms));
  Client client(another, holder);
  ASSERT_TRUE(client.connect());
  ASSERT_TRUE(holder.holds());
  EXPECT_LT(stop(), Publisher::kStopLimit);
  auto gone = std::async(std::launch::async, [this] { publisher.reset(); });
  EXPECT_EQ(gone.wait_for(3s), std::future_status::ready);
  holder.release();
}

TEST_F(BrokerFaults, WhatIsTooLongForTheBrokerIsNeverSent) {
  support::Mosquitto broker("max_packet_size 3000\n");
  ASSERT_TRUE(broker.start());
  make(settings(broker.port()));
  ASSERT_TRUE(connected());
  ASSERT_TRUE(subscribe({{"#", 1}}));
  open();
  Message longest = answer("fits", "x");
  longest.correlation = std::string(2980, 'c');
  longest.correlation->resize(2980 - (packet_size(longest, 5, 1) - 3000));
  ASSERT_EQ(packet_size(longest, 5, 1), 3000U);
  Message too_long = longest;
  too_long.topic = "fits_not";
  Message big = answer("big", std::string(100, 'x'));
  big.correlation = std::string(2880, 'c');
  publisher->publish({too_long, big, longest, {.topic = "v", .payload = "1"}});
  ASSERT_TRUE(run_until([this] { return has_message("fits") && has_message("v"); }));
  EXPECT_FALSE(has_message("fits_not"));
  EXPECT_EQ(disconnections, 0U);
  EXPECT_EQ(publisher->counts().messages_dropped, has_message("big") ? 1U : 2U);
  EXPECT_TRUE(is_said("fits_not is longer"));
}

TEST_F(BrokerFaults, AConnectionThatBreaksBehindASubscribeRefusesNothing) {
  for (const bool speaks_5 : {false, true}) {
    TinyBroker broker({.speaks_5 = speaks_5, .closes_on_subscribe = true});
    connections.clear();
    disconnections = 0;
    make(settings(broker.port()));
    ASSERT_TRUE(connected());
    publisher->subscribe(connections.back(), {{"x", 1}, {"y", 1}});
    ASSERT_TRUE(run_until([this] { return disconnections > 0; }));
    ASSERT_TRUE(connected(2));
    EXPECT_TRUE(grants.empty()) << "nobody has answered";
    (void)stop();
  }
}

}  // namespace
}  // namespace mqtt
