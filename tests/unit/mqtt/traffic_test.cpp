#include "bridges/mqtt/traffic.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/unit/mqtt/messages.h"

namespace mqtt {
namespace {

using namespace std::chrono_literals;
using test::answer;
using test::value;
using Texts = std::vector<std::string>;

class TrafficTest : public testing::Test {
 protected:
  void SetUp() override { begin(); }

  void begin(const BrokerLimits& limits = {}) {
    traffic_.begin(limits, 5, now_);
    traffic_.open(now_);
  }
  void push(std::vector<Message> batch) { traffic_.push(std::move(batch), now_); }
  /// Sends what may leave.
  std::vector<const Message*> send() {
    std::vector<const Message*> sent;
    while (traffic_.may_send(now_)) {
      if (const Message* const message = traffic_.next(now_)) {
        sent.push_back(message);
      }
    }
    return sent;
  }
  void acknowledge(const Message* message, Delivery delivery = Delivery::done, int code = 0) {
    traffic_.acknowledged(message, delivery, code, now_);
  }
  /// Sends until nothing may leave, acknowledging each; but a broker that hates a topic ends the connection there.
  Texts send_to(const std::string& hated) {
    Texts taken;
    for (auto sent = send(); !sent.empty(); sent = send()) {
      for (const Message* const message : sent) {
        if (message->topic == hated) {
          traffic_.end(true, now_);
          return taken;
        }
        taken.push_back(message->topic + "=" + message->payload);
        acknowledge(message);
      }
    }
    return taken;
  }
  /// As the bridge does with each connection.
  Texts announce_to(const std::string& hated, const std::string& payload = "1") {
    begin();
    push({value("a", "1"), value("bad", payload), value("c", "1")});
    return send_to(hated);
  }

  Texts said_;
  Traffic traffic_{1, [this](Level, std::string text) { said_.push_back(std::move(text)); }};
  Traffic::TimePoint now_{1h};
};

TEST_F(TrafficTest, SendsNothingBeforeItIsOpenedAndNoMoreThanItsWindow) {
  traffic_.begin({.packet = 0, .window = 2}, 5, now_);
  push({value("a", "1"), value("b", "1"), value("c", "1")});
  EXPECT_TRUE(send().empty());
  traffic_.open(now_);
  const auto sent = send();
  ASSERT_EQ(sent.size(), 2U);
  acknowledge(sent[1]);
  acknowledge(sent[1]);
  EXPECT_EQ(send().size(), 1U);
  EXPECT_FALSE(traffic_.all_said(now_));
}

TEST_F(TrafficTest, AConnectionThatAcknowledgesNothingIsStalled) {
  push({value("a", "1")});
  const auto sent = send();
  now_ += Traffic::kStalled;
  EXPECT_FALSE(traffic_.stalled(now_));
  EXPECT_TRUE(traffic_.stalled(now_ + 1ms));
  acknowledge(sent[0]);
  EXPECT_FALSE(traffic_.stalled(now_ + 1h)) << "nothing is under way";
}

TEST_F(TrafficTest, IsStuckWhereNothingLeavesThatCould) {
  now_ += 1h;
  EXPECT_FALSE(traffic_.stuck(now_)) << "nothing waits";
  push({value("a", "1")});
  now_ += Traffic::kStuck;
  push({value("a", "2")});
  EXPECT_FALSE(traffic_.stuck(now_));
  now_ += 1ms;
  EXPECT_TRUE(traffic_.stuck(now_)) << "nobody has called next()";
  const auto sent = send();
  push({value("a", "3")});
  EXPECT_FALSE(traffic_.stuck(now_ + 1s));
}

TEST_F(TrafficTest, IsNotStuckWhereNothingMayLeave) {
  traffic_.begin({}, 5, now_);
  push({value("a", "1")});
  EXPECT_FALSE(traffic_.stuck(now_ + 1h)) << "it was not opened";
  begin({.packet = 0, .window = 1});
  push({value("b", "1")});
  const auto sent = send();
  EXPECT_FALSE(traffic_.stuck(now_ + 1h)) << "the window is full";
  traffic_.end(false, now_);
  EXPECT_FALSE(traffic_.stuck(now_ + 1h));
}

TEST_F(TrafficTest, WhatIsTooLongIsDroppedAndSaidOnceForEachTopic) {
  begin({.packet = 100, .window = 16});
  for (int i = 0; i < 3; ++i) {
    push({value("a", std::string(100, 'x')), value("b", "1")});
    EXPECT_EQ(send_to(""), Texts{"b=1"});
  }
  EXPECT_EQ(traffic_.counts().messages_dropped, 3U);
  EXPECT_EQ(said_.size(), 1U);
}

TEST_F(TrafficTest, WhatTheBrokerRefusesIsCountedAndSaidOnceForEachCode) {
  push({value("a", "1"), value("b", "1"), value("c", "1")});
  const auto sent = send();
  acknowledge(sent.at(0), Delivery::refused, 0x87);
  acknowledge(sent.at(1), Delivery::refused, 0x87);
  acknowledge(sent.at(2), Delivery::refused, 0x97);
  EXPECT_EQ(traffic_.counts().messages_dropped, 3U);
  EXPECT_EQ(said_.size(), 2U);
  EXPECT_TRUE(traffic_.all_said(now_));
}

TEST_F(TrafficTest, AfterAnUnexplainedBreakWhatWasUnderWayLeavesAlone) {
  push({value("a", "1"), value("b", "1")});
  EXPECT_EQ(send().size(), 2U);
  traffic_.end(true, now_);
  begin();
  push({value("x", "1"), value("a", "1"), value("b", "1"), value("y", "1")});
  Texts order;
  for (auto sent = send(); !sent.empty(); sent = send()) {
    std::string together;
    for (const Message* const message : sent) {
      together += message->topic;
      acknowledge(message);
    }
    order.push_back(together);
  }
  EXPECT_EQ(order, (Texts{"x", "a", "b", "y"}));
  push({value("a", "2"), value("b", "2")});
  EXPECT_EQ(send().size(), 2U) << "they were acknowledged";
}

TEST_F(TrafficTest, ABreakForAnotherReasonSuspectsNothing) {
  push({value("a", "1"), value("b", "1")});
  EXPECT_EQ(send().size(), 2U);
  traffic_.end(false, now_);
  begin();
  push({value("a", "1"), value("b", "1")});
  EXPECT_EQ(send().size(), 2U);
}

TEST_F(TrafficTest, TheTopicThatEndsEachConnectionIsHeldBackAndAllElseIsPublished) {
  (void)announce_to("bad");
  (void)announce_to("bad");
  ASSERT_EQ(said_.size(), 1U);
  EXPECT_NE(said_[0].find("bad is published"), std::string::npos) << said_[0];
  EXPECT_EQ(announce_to("bad"), (Texts{"a=1", "c=1"}));
  EXPECT_EQ(traffic_.counts().messages_dropped, 1U);
  push({value("bad", "1"), value("c", "2")});
  EXPECT_EQ(send_to("bad"), Texts{"c=2"});
  EXPECT_TRUE(traffic_.all_said(now_)) << "what is held back is no reason to wait";
  EXPECT_EQ(traffic_.counts().messages_dropped, 1U);
}

TEST_F(TrafficTest, WhatIsHeldBackIsTriedAgainWhenItChanges) {
  (void)announce_to("bad");
  (void)announce_to("bad");
  EXPECT_EQ(announce_to("", "2"), (Texts{"a=1", "bad=2", "c=1"}));
  push({value("bad", "1")});
  EXPECT_EQ(send_to(""), Texts{"bad=1"}) << "all is forgiven";
}

TEST_F(TrafficTest, ATopicThatIsRefusedWhateverItSaysIsHeldBackWhateverItSays) {
  (void)announce_to("bad");
  (void)announce_to("bad");
  (void)announce_to("bad", "2");
  EXPECT_EQ(said_.size(), 2U);
  EXPECT_EQ(announce_to("bad", "3"), (Texts{"a=1", "c=1"}));
  now_ += Suspects::kHeldFor - 1s;
  EXPECT_EQ(traffic_.next(now_), nullptr);
  now_ += 1s;
  push({value("c", "2")});
  EXPECT_FALSE(traffic_.stuck(now_)) << "what was held back could not leave before";
  EXPECT_TRUE(send_to("bad").empty()) << "the one that waited is tried again, and the connection ends";
  EXPECT_EQ(announce_to("bad", "4"), (Texts{"a=1", "c=1"})) << "held back again";
  EXPECT_EQ(said_.size(), 2U);
  now_ += Suspects::kHeldFor;
  EXPECT_EQ(announce_to("", "5"), (Texts{"bad=5", "a=1", "c=1"})) << "in the place in which it waited";
}

TEST_F(TrafficTest, OnlineDoesNotWaitForWhatIsHeldBack) {
  (void)announce_to("bad");
  (void)announce_to("bad");
  begin();
  push({value("bad", "1"), value("c", "1"), {.topic = "B", .payload = "online", .after_all = true}});
  EXPECT_EQ(send_to("bad"), (Texts{"c=1", "B=online"}));
}

TEST_F(TrafficTest, WhatIsHeldBackIsPublishedInTheEndThoughNobodySaysItAgain) {
  (void)announce_to("bad");
  (void)announce_to("bad");
  EXPECT_EQ(announce_to("bad"), (Texts{"a=1", "c=1"}));
  now_ += Suspects::kHeldFor;
  const Message* const released = traffic_.next(now_);
  ASSERT_NE(released, nullptr);
  EXPECT_EQ(released->topic, "bad");
}

TEST_F(TrafficTest, OneThatWasAloneUnderWayForLongDidNotEndTheConnection) {
  (void)announce_to("bad");
  begin();
  push({value("bad", "1")});
  EXPECT_EQ(send().size(), 1U);
  now_ += Suspects::kPrompt + 1ms;
  traffic_.end(true, now_);
  EXPECT_EQ(announce_to(""), (Texts{"a=1", "bad=1", "c=1"}));
  EXPECT_TRUE(said_.empty());
}

TEST_F(TrafficTest, AnAnswerIsTriedOnTwoConnectionsAndSuspectsNothing) {
  push({answer("1")});
  EXPECT_EQ(send().size(), 1U);
  traffic_.end(true, now_);
  begin();
  EXPECT_EQ(send().size(), 1U);
  traffic_.end(true, now_);
  EXPECT_EQ(traffic_.counts().answers_dropped, 1U);
  ASSERT_EQ(said_.size(), 1U);
  EXPECT_NE(said_[0].find("answers dropped"), std::string::npos);
  begin();
  push({answer("2"), answer("3")});
  EXPECT_EQ(send().size(), 2U);
}

}  // namespace
}  // namespace mqtt
