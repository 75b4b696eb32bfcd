// Several brokers: which one is in use when one of them stops, freezes, cannot be reached, or refuses us; and the way
// back to the first.

#include <gtest/gtest.h>

#include <algorithm>
#include <future>
#include <string>
#include <vector>

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

constexpr const char* kBrokerStatus = "canopen/line3/status";
/// What is promised.
constexpr auto kOverWithin = 10s;

class Brokers : public test::PublisherFixture {
 public:
  void on_connected(const Connected& connection) override {
    PublisherFixture::on_connected(connection);
    used.push_back(connection.broker);
    // As the bridge does.
    publisher->publish({{.topic = kBrokerStatus, .payload = "online", .kind = MessageKind::status, .after_all = true}});
    publisher->open(connection.id);
  }
  void on_may_leave(ConnectionId connection, bool may) override {
    ++offers;
    if (!may) {
      return;
    }
    publisher->leave(connection,
                     {{.topic = "canopen/line3/pump1/status", .payload = "offline"},
                      {.topic = kBrokerStatus, .payload = "gone", .kind = MessageKind::status, .after_all = true}});
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
    // As patient as a real one, but for the scale: what each of them is for a real one is told by PublisherSettings.
    made.quiet = 500ms;
    made.stalled = 1500ms;
    made.hurried = 1500ms;
    return made;
  }
  /// Of one who is back at the first as soon as it was reachable for a moment.
  static PublisherSettings homesick(const std::vector<std::uint16_t>& ports) {
    PublisherSettings made = of(ports);
    made.return_after = 600ms;
    made.look_interval = 1s;  // three of them missed begin the time anew, and the thread looks about each half second
    return made;
  }
  [[nodiscard]] bool is_in_use(std::uint16_t port, std::chrono::milliseconds limit = kOverWithin) {
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
    return run_until([&] { return retained(broker, kBrokerStatus) == "1 " + payload + "\n"; });
  }

  std::vector<std::string> used;  ///< Brokers, in the order of their connections.
  std::vector<std::string> failures;
  std::size_t offers = 0;  ///< Of the way back.
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

TEST_F(TwoBrokers, ABrokerThatIsQuietAndAnswersIsKept) {
  TinyBroker first({.speaks_5 = true});
  make(of({first.port(), second_.port()}));
  ASSERT_TRUE(is_in_use(first.port()));
  // It is asked anew each time it answered; unanswered, the first question would have ended the connection by then.
  EXPECT_TRUE(run_until([&first] { return first.unsubscribes() >= 5; }));
  EXPECT_EQ(disconnections, 0U);
  EXPECT_TRUE(given_back.empty());
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
  EXPECT_EQ(retained(second_, kBrokerStatus), "1 gone\n") << "no will is left behind";
  EXPECT_NE(reasons.back().find(name(second_.port()) + ": left, for the first broker"), std::string::npos)
      << reasons.back();
  first_.stop();
  EXPECT_TRUE(is_in_use(second_.port())) << "and again";
}

TEST_F(TwoBrokers, AnswersThatWaitGoAlong) {
  begin(of({first_.port(), second_.port()}));
  // A session that keeps what comes.
  const std::string asker =
      "mosquitto_sub -c -i asker -q 1 -t answers/1 -h 127.0.0.1 -p " + std::to_string(second_.port()) + " 2>&1 -W 20 ";
  ASSERT_EQ(test::output_of(asker + "-E"), "");
  first_.freeze();
  publisher->publish({{.topic = "answers/1", .payload = "a", .kind = MessageKind::answer, .retained = false}});
  ASSERT_TRUE(is_in_use(second_.port()));
  auto heard = std::async(std::launch::async, [&asker] { return test::output_of(asker + "-C 1"); });
  EXPECT_TRUE(run_until([&heard] { return heard.wait_for(0s) == std::future_status::ready; }));
  EXPECT_EQ(heard.get(), "a\n");
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
  PublisherSettings made = of({one.port()});
  made.brokers.front().host = "broker.example";
  made.resolver = [](const config::Endpoint&) { return std::vector<std::string>{"127.0.0.1", "127.0.0.2"}; };
  make(std::move(made));
  ASSERT_TRUE(connected());
  one.freeze();
  const FirstWords next("127.0.0.2", one.port());
  EXPECT_TRUE(run_until([&next] { return next.has_client(); }, kOverWithin));
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

TEST_F(Brokers, AFirstOneThatAnswersAndRefusesUsDisturbsNobodyAtTheSecond) {
  TinyBroker first({.refusal = 3});  // of 3.1.1: unavailable
  Mosquitto second;
  ASSERT_TRUE(second.start());
  make(homesick({first.port(), second.port()}));
  ASSERT_TRUE(is_in_use(second.port()));
  ASSERT_TRUE(run_until([this] { return is_said("takes no connection of ours"); })) << testing::PrintToString(notices);
  EXPECT_EQ(offers, 0U);
  EXPECT_EQ(used, std::vector<std::string>{name(second.port())});
  EXPECT_EQ(disconnections, 0U);
}

}  // namespace
}  // namespace mqtt
