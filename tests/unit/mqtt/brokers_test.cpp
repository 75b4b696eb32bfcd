// Several brokers: which one is in use when one of them stops, freezes, cannot be reached, or refuses us; and the way
// back to the first.

#include <gtest/gtest.h>

#include <algorithm>
#include <future>
#include <string>
#include <vector>

#include "bridges/mqtt/reach.h"
#include "tests/support/mosquitto.h"
#include "tests/unit/mqtt/first_words.h"
#include "tests/unit/mqtt/on_mosquitto.h"
#include "tests/unit/mqtt/tiny_broker.h"

namespace mqtt {
namespace {

using namespace std::chrono_literals;
using support::Mosquitto;
using test::FirstWords;
using test::TinyBroker;

constexpr const char* kStatus = "canopen/line3/status";
/// What is promised.
constexpr auto kFailOver = 10s;

class Brokers : public test::PublisherFixture {
 public:
  void on_connected(const Connected& connection) override {
    PublisherFixture::on_connected(connection);
    used.push_back(connection.broker);
    // As the bridge does.
    publisher->publish({{.topic = kStatus, .payload = "online", .kind = MessageKind::status, .after_all = true}});
    publisher->open(connection.id);
  }
  void on_may_leave(ConnectionId connection) override {
    publisher->leave(connection,
                     {{.topic = "canopen/line3/pump1/status", .payload = "offline"},
                      {.topic = kStatus, .payload = "gone", .kind = MessageKind::status, .after_all = true}});
  }
  void on_no_connection(const std::string& why) override { failures.push_back(why); }

 protected:
  static std::string name(std::uint16_t port) { return "127.0.0.1:" + std::to_string(port); }
  static PublisherSettings of(const std::vector<std::uint16_t>& ports) {
    PublisherSettings made = settings(ports.front());
    made.brokers.clear();
    for (const std::uint16_t port : ports) {
      made.brokers.push_back({"127.0.0.1", port});
    }
    made.pause_after_refusal = 60s;
    return made;
  }
  /// Of one who is back at the first as soon as it was reachable for a moment.
  static PublisherSettings homesick(const std::vector<std::uint16_t>& ports) {
    PublisherSettings made = of(ports);
    made.return_after = 1500ms;
    made.look_interval = 1s;
    return made;
  }
  [[nodiscard]] bool is_in_use(std::uint16_t port, std::chrono::milliseconds limit = kFailOver) {
    return run_until([&] { return connections.size() > disconnections && used.back() == name(port); }, limit);
  }
  [[nodiscard]] bool is_said(const std::string& part) const {
    return std::ranges::any_of(notices, [&part](const auto& text) { return text.find(part) != std::string::npos; });
  }
  [[nodiscard]] static std::string retained(const Mosquitto& broker, const std::string& topic) {
    return test::output_of("mosquitto_sub -V 5 -W 1 -C 1 -F '%r %p' -h 127.0.0.1 -p " + std::to_string(broker.port()) +
                           " -t " + topic + " 2>/dev/null");
  }
  [[nodiscard]] bool is_retained(const Mosquitto& broker, const std::string& payload) {
    return run_until([&] { return retained(broker, kStatus) == "1 " + payload + "\n"; });
  }

  std::vector<std::string> used;  ///< Brokers, in the order of their connections.
  std::vector<std::string> failures;
};

class TwoBrokers : public Brokers {
 protected:
  void SetUp() override {
    ASSERT_TRUE(first_.start());
    ASSERT_TRUE(second_.start());
  }
  void begin(PublisherSettings made) {
    make(std::move(made));
    ASSERT_TRUE(is_in_use(first_.port()));
    ASSERT_TRUE(is_retained(first_, "online"));
  }

  Mosquitto first_;
  Mosquitto second_;
};

TEST_F(TwoBrokers, WhereTheFirstStopsTheSecondIsUsed) {
  begin(of({first_.port(), second_.port()}));
  first_.stop();
  EXPECT_TRUE(is_in_use(second_.port()));
  EXPECT_TRUE(is_retained(second_, "online"));
  EXPECT_TRUE(is_said("MQTT: " + name(first_.port()) + ": ")) << testing::PrintToString(notices);
  EXPECT_TRUE(is_said("connected to " + name(second_.port())));
  EXPECT_TRUE(reasons.at(0).starts_with(name(first_.port()) + ": ")) << reasons[0];
}

// Nothing is published: nobody would notice by that.
TEST_F(TwoBrokers, WhereTheFirstFreezesTheSecondIsUsedAndTheFirstSaysOfflineLater) {
  begin(of({first_.port(), second_.port()}));
  first_.freeze();
  EXPECT_TRUE(is_in_use(second_.port()));
  first_.resume();
  EXPECT_TRUE(reasons.at(0).find("acknowledges nothing") != std::string::npos) << reasons[0];
  EXPECT_TRUE(is_retained(first_, "offline")) << "its will";
  EXPECT_TRUE(is_retained(second_, "online"));
}

TEST_F(TwoBrokers, WhereTheFirstFreezesWithMessagesUnderWayTheSecondIsUsed) {
  begin(of({first_.port(), second_.port()}));
  first_.freeze();
  for (int i = 0; i < 100; ++i) {
    publisher->publish({{.topic = "v" + std::to_string(i), .payload = std::string(1000, 'x')}});
  }
  EXPECT_TRUE(is_in_use(second_.port()));
}

// It lets connections come about while it is frozen.
TEST_F(TwoBrokers, AFirstOneThatIsFrozenAtTheStartIsPassedOver) {
  first_.freeze();
  make(of({first_.port(), second_.port()}));
  EXPECT_TRUE(is_in_use(second_.port()));
  EXPECT_TRUE(std::ranges::any_of(failures, [this](const std::string& why) {
    return why.starts_with(name(first_.port()) + ": ");
  })) << "for B/health";
}

TEST_F(TwoBrokers, NothingIsSaidToABrokerThatIsQuietAndLives) {
  make(of({first_.port(), second_.port()}));
  ASSERT_TRUE(is_in_use(first_.port()));
  EXPECT_FALSE(run_until([this] { return disconnections > 0 || !given_back.empty(); }, 6s));
}

TEST_F(TwoBrokers, BackAtTheFirstTheSecondIsLeftInOrder) {
  first_.stop();
  PublisherSettings made = homesick({first_.port(), second_.port()});
  made.client.will_delay = 0s;
  make(std::move(made));
  ASSERT_TRUE(is_in_use(second_.port()));
  ASSERT_TRUE(is_retained(second_, "online"));
  ASSERT_TRUE(first_.start());
  ASSERT_TRUE(is_in_use(first_.port()));
  EXPECT_TRUE(is_retained(first_, "online"));
  EXPECT_TRUE(is_retained(second_, "gone"));
  EXPECT_EQ(retained(second_, "canopen/line3/pump1/status"), "1 offline\n");
  EXPECT_FALSE(run_until([this] { return disconnections > 1; }, 2s));
  EXPECT_EQ(retained(second_, kStatus), "1 gone\n") << "no will is left behind";
  EXPECT_NE(reasons.back().find(name(second_.port()) + ": left, for the first broker"), std::string::npos)
      << reasons.back();
  first_.stop();
  EXPECT_TRUE(is_in_use(second_.port())) << "and again";
}

TEST_F(TwoBrokers, AnswersThatWaitGoAlong) {
  first_.stop();
  make(homesick({first_.port(), second_.port()}));
  ASSERT_TRUE(is_in_use(second_.port()));
  second_.freeze();
  publisher->publish({{.topic = "answers/1", .payload = "a", .kind = MessageKind::answer, .retained = false}});
  ASSERT_TRUE(first_.start());
  ASSERT_TRUE(run_until([this] { return connections.size() > disconnections && used.back() == name(first_.port()); }));
  ASSERT_TRUE(subscribe({{"x", 1}}));
  EXPECT_EQ(publisher->counts().answers_dropped, 0U);
}

TEST_F(Brokers, AFirstOneThatNobodyAnswersAtIsPassedOverWithAllItsAddresses) {
  FirstWords one;
  ASSERT_TRUE(one.fill());
  FirstWords other("127.0.0.2", one.port());
  ASSERT_TRUE(other.fill());
  Mosquitto second;
  ASSERT_TRUE(second.start());
  PublisherSettings made = of({one.port(), second.port()});
  made.brokers[0].host = "first.example";
  made.resolver = [](const config::Endpoint& endpoint) {
    return endpoint.host == "first.example" ? std::vector<std::string>{"127.0.0.1", "127.0.0.2"}
                                            : std::vector<std::string>{endpoint.host};
  };
  make(std::move(made));
  EXPECT_TRUE(is_in_use(second.port()));
}

TEST_F(Brokers, AFirstOneWhoseNameIsNotAnsweredIsPassedOver) {
  Mosquitto second;
  ASSERT_TRUE(second.start());
  std::promise<void> release;
  PublisherSettings made = of({1, second.port()});
  made.brokers[0].host = "first.example";
  made.resolver = [released = release.get_future().share()](const config::Endpoint& endpoint) {
    if (endpoint.host == "first.example") {
      released.wait();
    }
    return std::vector<std::string>{"127.0.0.1"};
  };
  make(std::move(made));
  EXPECT_TRUE(is_in_use(second.port()));
  release.set_value();
}

TEST_F(Brokers, AnAddressThatFallsSilentIsFollowedByTheNextOfItsName) {
  Mosquitto one;
  ASSERT_TRUE(one.start());
  PublisherSettings made = settings(one.port());
  made.brokers.front().host = "broker.example";
  made.resolver = [](const config::Endpoint&) { return std::vector<std::string>{"127.0.0.1", "127.0.0.2"}; };
  make(std::move(made));
  ASSERT_TRUE(connected());
  one.freeze();
  const FirstWords next("127.0.0.2", one.port());
  EXPECT_TRUE(run_until([&next] { return next.has_client(); }, kFailOver));
}

TEST_F(Brokers, ABrokerThatAcknowledgesNothingIsLeft) {
  TinyBroker first({.speaks_5 = true, .by_hand = true});
  Mosquitto second;
  ASSERT_TRUE(second.start());
  make(of({first.port(), second.port()}));
  ASSERT_TRUE(is_in_use(first.port()));
  EXPECT_TRUE(is_in_use(second.port()));
  first.take_all();
}

TEST_F(Brokers, ARefusalKeepsNobodyFromTheSecond) {
  TinyBroker first({.refusal = 5});
  Mosquitto second;
  ASSERT_TRUE(second.start());
  make(of({first.port(), second.port()}));
  EXPECT_TRUE(is_in_use(second.port(), 5s));
  EXPECT_TRUE(is_said("trying " + name(second.port()))) << testing::PrintToString(notices);
  EXPECT_FALSE(failures.empty());
}

TEST_F(Brokers, AnOlderBrokerIsUsedWhereItIsTheFirst) {
  TinyBroker first({.closes_on_5 = true});
  Mosquitto second;
  ASSERT_TRUE(second.start());
  make(of({first.port(), second.port()}));
  EXPECT_TRUE(is_in_use(first.port()));
  EXPECT_EQ(first.levels(), (std::vector<int>{5, 5, 4}));
}

TEST_F(Brokers, AReturnThatFailsLeadsBackAndIsTriedAgain) {
  TinyBroker first({.refusal = 3});  // of 3.1.1: unavailable
  Mosquitto second;
  ASSERT_TRUE(second.start());
  make(homesick({first.port(), second.port()}));
  ASSERT_TRUE(is_in_use(second.port()));
  ASSERT_TRUE(run_until([this] { return connections.size() >= 3; }));
  EXPECT_TRUE(std::ranges::all_of(used, [&second](const std::string& each) { return each == name(second.port()); }));
  EXPECT_TRUE(is_in_use(second.port()));
}

TEST(Reach, ABrokerThatLivesIsReachedAndOneThatStandsStillIsNot) {
  Mosquitto broker;
  ASSERT_TRUE(broker.start());
  const config::Endpoint at{"127.0.0.1", broker.port()};
  EXPECT_TRUE(reaches(at, {"127.0.0.1"}, {}, 2s));
  broker.freeze();
  EXPECT_FALSE(reaches(at, {"127.0.0.1"}, {}, 300ms));
  broker.resume();
  broker.stop();
  EXPECT_FALSE(reaches(at, {"127.0.0.1"}, {}, 300ms));
  EXPECT_FALSE(reaches(at, {}, {}, 300ms));
}

TEST(Reach, TheQuestionEndsNoSessionOfOurClientId) {
  Mosquitto broker;
  ASSERT_TRUE(broker.start());
  const std::string at = " -h 127.0.0.1 -p " + std::to_string(broker.port());
  auto heard = std::async(std::launch::async, [&at] {
    return test::output_of("mosquitto_sub -i canopen-gateway-line3 -W 5 -C 1 -t a" + at + " 2>&1");
  });
  for (int i = 0; i < 20; ++i) {
    EXPECT_TRUE(reaches({"127.0.0.1", broker.port()}, {"127.0.0.1"}, {}, 2s));
  }
  while (heard.wait_for(50ms) != std::future_status::ready) {
    (void)test::output_of("mosquitto_pub -t a -m x" + at);
  }
  EXPECT_EQ(heard.get(), "x\n");
}

}  // namespace
}  // namespace mqtt
