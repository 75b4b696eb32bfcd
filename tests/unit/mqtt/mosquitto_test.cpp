// The publisher and the bridge on a real broker. What came out is read back by mosquitto's own programs.

#include "tests/support/mosquitto.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <future>
#include <string>

#include "bridges/mqtt/publisher.h"
#include "tests/unit/mqtt/on_mosquitto.h"

namespace mqtt {
namespace {

using namespace std::chrono_literals;
using support::Mosquitto;
using test::output_of;

class OnMosquitto : public test::OnMosquitto {};

TEST_F(OnMosquitto, SpeaksMqtt5AndPublishesRetained) {
  make(settings(broker_.port()));
  ASSERT_TRUE(connected());
  EXPECT_NE(notices.at(0).find("MQTT 5"), std::string::npos) << notices[0];
  publisher->publish({{.topic = "canopen/line3/status", .payload = "online"}});
  open();
  EXPECT_TRUE(is_retained("canopen/line3/status", "online"));
  publisher->publish({{.topic = "canopen/line3/status", .payload = ""}});
  EXPECT_TRUE(run_until([this] { return retained("canopen/line3/status").empty(); })) << "emptied";
}

TEST_F(OnMosquitto, SaysItsWillItselfWhereItEndsWithoutLastWords) {
  make(settings(broker_.port()));
  ASSERT_TRUE(connected());
  publisher->publish({{.topic = "canopen/line3/status", .payload = "online"}});
  open();
  ASSERT_TRUE(is_retained("canopen/line3/status", "online"));
  publisher.reset();  // not stopped before
  EXPECT_TRUE(is_retained("canopen/line3/status", "offline"));
}

TEST_F(OnMosquitto, AnOrderlyEndSaysItsLastWordsAndNoWill) {
  make(settings(broker_.port()));
  ASSERT_TRUE(connected());
  open();
  EXPECT_LT(stop({{.topic = "canopen/line3/pump1/status", .payload = "offline"},
                  {.topic = "canopen/line3/status", .payload = "gone"}}),
            3s);
  EXPECT_EQ(retained("canopen/line3/pump1/status"), "1 offline\n");
  EXPECT_EQ(retained("canopen/line3/status"), "1 gone\n") << "not the will";
}

TEST_F(OnMosquitto, BringsCommandsWithTheirProperties) {
  make(settings(broker_.port()));
  ASSERT_TRUE(connected());
  ASSERT_TRUE(subscribe({{"canopen/line3/+/set", 1}, {"canopen/line3/+/+/set", 1}}));
  EXPECT_TRUE(grants[0]);
  publish_with(
      "-V 5 -q 1 -t canopen/line3/pump1/set -m '{\"a\":1}' -D publish response-topic answers/1 "
      "-D publish correlation-data c17 -D publish message-expiry-interval 30");
  ASSERT_TRUE(run_until([this] { return !messages.empty(); }));
  const Incoming& message = messages[0];
  EXPECT_EQ(message.topic, "canopen/line3/pump1/set");
  EXPECT_EQ(message.payload, "{\"a\":1}");
  EXPECT_EQ(message.response_topic, "answers/1");
  EXPECT_EQ(message.correlation, "c17");
  ASSERT_TRUE(message.expiry);
  EXPECT_LE(*message.expiry, 30U);
  EXPECT_GE(*message.expiry, 20U);
  EXPECT_FALSE(message.retained);
}

TEST_F(OnMosquitto, ARetainedCommandIsKnownAsSuchEvenWhenItIsPublishedNow) {
  publish_with("-r -t canopen/line3/pump1/set -m before");
  make(settings(broker_.port()));
  ASSERT_TRUE(connected());
  ASSERT_TRUE(subscribe({{"canopen/line3/+/set", 1}}));
  ASSERT_TRUE(run_until([this] { return !messages.empty(); }));
  EXPECT_TRUE(messages[0].retained);
  publish_with("-r -t canopen/line3/pump1/set -m now");
  ASSERT_TRUE(run_until([this] { return messages.size() >= 2; }));
  EXPECT_EQ(messages[1].payload, "now");
  EXPECT_TRUE(messages[1].retained) << "Retain As Published";
}

TEST_F(OnMosquitto, WhatIsUnsubscribedComesNoMore) {
  make(settings(broker_.port()));
  ASSERT_TRUE(connected());
  ASSERT_TRUE(subscribe({{"a/#", 1}, {"b/#", 1}, {"a/watched", 1, true}}));
  publish_with("-q 1 -t a/x -m 1");
  ASSERT_TRUE(run_until([this] { return has_message("a/x"); }));
  publisher->unsubscribe(connections.back() + 1, "b/#");  // of another connection
  publisher->unsubscribe(connections.back(), "a/#");
  publisher->unsubscribe(connections.back(), "a/watched");
  ASSERT_TRUE(run_until([this] { return given_back.size() == 2; }));
  EXPECT_EQ(given_back, (std::vector<std::string>{"a/#", "a/watched"}));
  messages.clear();
  publish_with("-q 1 -t a/x -m 2");
  publish_with("-q 1 -t a/watched -m 2");
  publish_with("-q 1 -t b/x -m 2");
  ASSERT_TRUE(run_until([this] { return has_message("b/x"); }));
  EXPECT_EQ(messages.size(), 1U);
  ASSERT_TRUE(subscribe({{"a/#", 1}})) << "and again";
  publish_with("-q 1 -t a/x -m 3");
  EXPECT_TRUE(run_until([this] { return has_message("a/x"); }));
}

TEST_F(OnMosquitto, AConnectionThatIsDroppedIsEndedInOrderAndMadeAgain) {
  make(settings(broker_.port()));
  ASSERT_TRUE(connected());
  publisher->publish({{.topic = "canopen/line3/status", .payload = "online"}});
  open();
  ASSERT_TRUE(is_retained("canopen/line3/status", "online"));
  publisher->drop(connections.back() + 1, "of another connection");
  publisher->drop(connections.back(), "enough of it");
  ASSERT_TRUE(connected(2));
  EXPECT_EQ(reasons, std::vector<std::string>{"enough of it"});
  EXPECT_TRUE(std::ranges::any_of(
      notices, [](const std::string& text) { return text.find("enough of it; trying again") != std::string::npos; }));
  EXPECT_TRUE(is_retained("canopen/line3/status", "offline")) << "until the next one says otherwise";
  publisher->drop(connections.front(), "it is gone already");
  ASSERT_TRUE(subscribe({{"x", 1}}));
  EXPECT_EQ(disconnections, 1U);
}

TEST_F(OnMosquitto, EchoesCorrelationDataOfAnyBytes) {
  make(settings(broker_.port()));
  ASSERT_TRUE(connected());
  ASSERT_TRUE(subscribe({{"answers/#", 1}}));
  const std::string bytes("\0\xFF\x01", 3);
  publisher->publish(
      {{.topic = "answers/1", .payload = "x", .kind = MessageKind::answer, .retained = false, .correlation = bytes}});
  open();
  ASSERT_TRUE(run_until([this] { return has_message("answers/1"); }));
  EXPECT_EQ(messages.back().correlation, bytes);
  EXPECT_FALSE(messages.back().retained);
}

TEST_F(OnMosquitto, ConnectsAgainAfterTheBrokerWasGone) {
  make(settings(broker_.port()));
  ASSERT_TRUE(connected());
  open();
  broker_.stop();
  ASSERT_TRUE(run_until([this] { return disconnections == 1; }));
  publisher->publish({{.topic = "t", .payload = "1"},
                      {.topic = "t", .payload = "2"},
                      {.topic = "answers/1", .payload = "a", .kind = MessageKind::answer, .retained = false}});
  ASSERT_TRUE(broker_.start());
  ASSERT_TRUE(connected(2));
  EXPECT_GT(connections[1], connections[0]);
  EXPECT_EQ(retained("t"), "") << "closed until it is opened";
  ASSERT_TRUE(subscribe({{"answers/#", 1}}));
  open();
  EXPECT_TRUE(is_retained("t", "2"));
  EXPECT_TRUE(run_until([this] { return has_message("answers/1"); })) << "an answer outlives the connection";
}

TEST_F(OnMosquitto, StartsWithoutABrokerAndFindsItLater) {
  broker_.stop();
  make(settings(broker_.port()));
  ASSERT_TRUE(run_until([this] { return !notices.empty(); }));
  EXPECT_NE(notices[0].find("no connection"), std::string::npos) << notices[0];
  ASSERT_TRUE(broker_.start());
  EXPECT_TRUE(connected());
}

TEST_F(OnMosquitto, LosesNothingOfManyMessages) {
  make(settings(broker_.port()));
  ASSERT_TRUE(connected());
  ASSERT_TRUE(subscribe({{"many/#", 1}}));
  open();
  constexpr std::size_t kMessages = 2000;
  for (std::size_t i = 0; i < kMessages; i += 50) {
    std::vector<Message> batch;
    for (std::size_t k = i; k < i + 50; ++k) {
      batch.push_back({.topic = "many/" + std::to_string(k % 10),
                       .payload = std::to_string(k),
                       .kind = MessageKind::answer,
                       .retained = false});
    }
    publisher->publish(std::move(batch));
    // More than wait at a time would be dropped.
    ASSERT_TRUE(run_until([&] { return messages.size() + Outbox::kMaxAnswers / 2 > i; })) << messages.size();
  }
  ASSERT_TRUE(run_until([this] { return messages.size() >= kMessages; })) << messages.size();
  for (std::size_t i = 0; i < kMessages; ++i) {
    ASSERT_EQ(messages[i].payload, std::to_string(i)) << "in order";
  }
}

TEST_F(OnMosquitto, StaysWithinTheReceiveMaximumOfTheBroker) {
  PublisherSettings made = settings(broker_.port());
  made.farewell = 4s;
  make(std::move(made));
  ASSERT_TRUE(connected());
  open();
  std::vector<Message> batch;
  for (int i = 0; i < 5000; ++i) {
    batch.push_back({.topic = "values/" + std::to_string(i), .payload = std::to_string(i)});
  }
  publisher->publish(std::move(batch));
  EXPECT_LT(stop({{.topic = "canopen/line3/last", .payload = "said"}}), 3s) << "beyond it Paho is many times slower";
  EXPECT_EQ(retained("canopen/line3/last"), "1 said\n");
}

TEST_F(OnMosquitto, ABrokerThatHangsHoldsUpNeitherLoopNorEnd) {
  make(settings(broker_.port()));
  ASSERT_TRUE(connected());
  open();
  broker_.freeze();
  std::chrono::nanoseconds longest{};
  for (int i = 0; i < 2000; ++i) {
    const auto begun = Clock::now();
    publisher->publish({{.topic = "t" + std::to_string(i % 10), .payload = std::string(1000, 'x')}});
    longest = std::max(longest, std::chrono::nanoseconds(Clock::now() - begun));
  }
  EXPECT_LT(longest, 500ms) << "of a call on the loop, on a busy machine";
  EXPECT_LT(stop({{.topic = "canopen/line3/status", .payload = "offline"}}), 6s);
  broker_.resume();
  EXPECT_TRUE(is_retained("canopen/line3/status", "offline")) << "said by the will";
}

class OnStrictMosquitto : public OnMosquitto {
 protected:
  void SetUp() override {}
};

TEST_F(OnStrictMosquitto, TakesUserNameAndPassword) {
  EXPECT_EQ(output_of("mosquitto_passwd -b -c " + (broker_.directory() / "users").string() + " line3 secret 2>&1"), "");
  Mosquitto strict("password_file " + (broker_.directory() / "users").string() + "\nallow_anonymous false\n");
  ASSERT_TRUE(strict.start());
  PublisherSettings made = settings(strict.port());
  made.client.username = "line3";
  made.client.password = "wrong";
  make(made);
  ASSERT_TRUE(run_until([this] { return !notices.empty(); }));
  EXPECT_NE(notices[0].find("ot authorized"), std::string::npos) << notices[0];
  publisher.reset();
  made.client.password = "secret";
  make(made);
  EXPECT_TRUE(connected());
}

TEST_F(OnStrictMosquitto, SaysWhenItMayNotPublish) {
  const auto rules = broker_.directory() / "acl";
  std::ofstream(rules) << "topic write open/#\n";
  Mosquitto strict("acl_file " + rules.string() + "\n");
  ASSERT_TRUE(strict.start());
  make(settings(strict.port()));
  ASSERT_TRUE(connected());
  open();
  publisher->publish({{.topic = "forbidden/1", .payload = "1"}, {.topic = "open/1", .payload = "1"}});
  EXPECT_TRUE(run_until([this] {
    return std::any_of(notices.begin(), notices.end(),
                       [](const std::string& text) { return text.find("refuses some") != std::string::npos; });
  }));
  // Nothing is left under way: the end does not wait for the acknowledgement of a refused message.
  EXPECT_LT(stop({{.topic = "open/2", .payload = "1"}}), 2s);
}

}  // namespace
}  // namespace mqtt
