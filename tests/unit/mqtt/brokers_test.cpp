// Several brokers: which one is in use when one of them stops, freezes, cannot be reached, or refuses us; and the way
// back to the first.

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <future>
#include <memory>
#include <string>
#include <vector>

#include "tests/support/mosquitto.h"
#include "tests/unit/mqtt/brokers_fixture.h"
#include "tests/unit/mqtt/first_words.h"
#include "tests/unit/mqtt/tiny_broker.h"

namespace mqtt {
namespace {

using namespace std::chrono_literals;
using support::Mosquitto;
using test::Brokers;
using test::kBrokerStatus;
using test::TinyBroker;
using test::TwoBrokers;

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

// Of a machine far away Paho tells a refused connection like one that a broker closed.
TEST_F(Brokers, AFirstOneThatIsNotThereIsNoBrokerThatClosesOnMqtt5) {
  auto first = std::make_unique<test::FirstWords>();
  const std::uint16_t port = first->port();
  Mosquitto second;
  ASSERT_TRUE(second.start());
  make(of({port, second.port()}));
  const int client = first->take();
  ASSERT_GE(client, 0);
  first.reset();
  close(client);
  ASSERT_TRUE(is_in_use(second.port()));
  EXPECT_TRUE(is_said(name(port) + ": the connection is refused; trying " + name(second.port())))
      << testing::PrintToString(notices);
}

TEST(PublisherSettings, LeaveTheNextBrokerTimeWithinWhatIsPromised) {
  constexpr auto kLastWord = 400ms;
  constexpr auto kName = 500ms;
  constexpr auto kCauseOfTls = 1000ms;
  constexpr auto kNextOne = 2000ms;
  const PublisherSettings real;
  EXPECT_LE(real.quiet + real.stalled + kLastWord + kName + kNextOne, test::kOverWithin) << "it froze";
  EXPECT_LE(real.first_pause + kName + real.turn + kCauseOfTls + kName + kNextOne, test::kOverWithin) << "it is gone";
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
