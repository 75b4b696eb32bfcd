// What a broker ends connections for.

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/unit/mqtt/traffic_fixture.h"

namespace mqtt {
namespace {

using namespace std::chrono_literals;
using test::answer;
using test::status;
using test::TrafficTest;
using test::value;

TEST_F(TrafficTest, WhatOneBrokerClosesOnIsPublishedAtOnceAtTheNext) {
  push({value("bad", "1"), value("c", "1")});
  EXPECT_EQ(send().size(), 2U);
  traffic_.end(true, now_);
  traffic_.at_broker(1);
  begin();
  push({value("bad", "1"), value("c", "1")});
  EXPECT_EQ(send().size(), 2U) << "none is suspected";
}

TEST_F(TrafficTest, WhatABrokerClosedOnIsRememberedAtItsNextConnectionAndWhileAnotherOneIsUsed) {
  push({value("bad", "1"), value("c", "1")});
  EXPECT_EQ(send().size(), 2U);
  traffic_.end(true, now_);
  traffic_.at_broker(0);  // at whatever address of it
  begin();
  push({value("bad", "1"), value("c", "1")});
  EXPECT_EQ(send().size(), 1U) << "it leaves alone";
  traffic_.end(true, now_);
  traffic_.at_broker(1);
  begin();
  traffic_.end(false, now_);
  traffic_.at_broker(0);
  begin();
  push({value("bad", "1"), value("c", "1")});
  const auto sent = send();
  ASSERT_EQ(sent.size(), 1U);
  EXPECT_EQ(sent[0]->topic, "c") << "the other one is held back";
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
  EXPECT_EQ(announce_to("bad"), (Texts{"a=1", "c=1", "B=online"}));
  EXPECT_EQ(traffic_.counts().messages_dropped, 1U);
  push({value("bad", "1"), value("c", "2")});
  EXPECT_EQ(send_to("bad"), Texts{"c=2"});
  EXPECT_TRUE(traffic_.all_said(now_)) << "what is held back is no reason to wait";
  EXPECT_EQ(traffic_.counts().messages_dropped, 1U);
}

TEST_F(TrafficTest, WhatIsHeldBackIsTriedAgainWhenItChanges) {
  (void)announce_to("bad");
  (void)announce_to("bad");
  EXPECT_EQ(announce_to("", "2"), (Texts{"a=1", "c=1", "B=online", "bad=2"}));
  push({value("bad", "1")});
  EXPECT_EQ(send_to(""), Texts{"bad=1"}) << "all is forgiven";
}

TEST_F(TrafficTest, ATopicThatEndsEachConnectionIsHeldBackForLongerEachTimeWhateverItSays) {
  const Texts others{"a=1", "c=1", "B=online"};
  (void)announce_to("bad");
  (void)announce_to("bad");
  EXPECT_EQ(announce_to("bad", "2"), others) << "and then the connection ended: it was another payload";
  EXPECT_EQ(said_.size(), 2U);
  for (auto hold = 2 * Suspects::kFirstHold; hold < Suspects::kLongestHold; hold *= 2) {
    EXPECT_EQ(announce_to("bad", "3"), others);
    now_ += hold - 1s;
    EXPECT_EQ(traffic_.next(now_), nullptr);
    now_ += 1s;
    push({value("c", "2")});
    EXPECT_TRUE(send_to("bad").empty()) << "the one that waited is tried again, and the connection ends";
  }
  EXPECT_EQ(announce_to("bad", "4"), others) << "held back again";
  now_ += Suspects::kLongestHold;
  EXPECT_EQ(send_to(""), Texts{"bad=4"});
  EXPECT_EQ(said_.size(), 2U);
}

// The network breaks in the same moment of each connection.
TEST_F(TrafficTest, AnAlarmThatBadLuckHitsEachTimeIsHeldBackForAMinuteAtMost) {
  begin();
  push({test::alarm("alarm", "on")});
  EXPECT_EQ(send().size(), 1U);
  traffic_.end(true, now_);
  begin();
  push({test::alarm("alarm", "on"), status("B", "online", true)});
  EXPECT_EQ(send_to("alarm"), Texts{});
  EXPECT_EQ(announce_to(""), (Texts{"a=1", "bad=1", "c=1", "B=online"}));
  push({test::alarm("alarm", "on")});
  now_ += Suspects::kFirstHold;
  for (int i = 0; i < 10; ++i) {
    ASSERT_EQ(send_to("alarm"), Texts{}) << i;
    EXPECT_EQ(announce_to(""), (Texts{"a=1", "bad=1", "c=1", "B=online"}));
    push({test::alarm("alarm", "on")});
    now_ += Suspects::kLongestHoldOfAlarms;
  }
  EXPECT_EQ(send_to(""), Texts{"alarm=on"});
  push({test::alarm("alarm", "on")});
  EXPECT_EQ(send_to(""), Texts{"alarm=on"}) << "all is forgiven";
}

TEST_F(TrafficTest, ManyTopicsThatEndTheConnectionKeepNothingElseBack) {
  const auto announce = [this] {
    begin();
    push({test::alarm("x", "1"), test::alarm("y", "1"), value("c", "1"), status("B", "online", true)});
  };
  for (const char* const hated : {"x", "x", "y"}) {  // the first time both were under way
    announce();
    EXPECT_EQ(send_to(hated), Texts{});
  }
  now_ += Suspects::kLongestHold;
  announce();
  EXPECT_EQ(send_to("x"), (Texts{"c=1", "B=online"})) << "before either is tried again";
}

TEST_F(TrafficTest, WhatPahoDidNotTakeIsNotSuspectedAndItsAnswerNotTried) {
  push({value("a", "1")});
  const auto sent = send();
  traffic_.end(true, now_);
  for (int i = 0; i < 3; ++i) {
    begin();
    push(i == 0 ? std::vector<Message>{value("a", "1"), answer("1")} : std::vector<Message>{value("a", "1")});
    const Message* const message = traffic_.next(now_);
    ASSERT_NE(message, nullptr);
    traffic_.not_sent(message, now_);
    traffic_.end(true, now_);
  }
  begin();
  push({value("a", "1")});
  EXPECT_EQ(send_to(""), (Texts{"reply=1", "a=1"}));
  EXPECT_TRUE(said_.empty());
}

TEST_F(TrafficTest, WhatIsHeldBackAtTheEndIsNotSaid) {
  (void)announce_to("bad");
  (void)announce_to("bad");
  begin();
  push({value("bad", "1")});
  EXPECT_TRUE(traffic_.all_said(now_));
  EXPECT_FALSE(traffic_.nothing_waits()) << "so the will is to be said";
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
  EXPECT_EQ(announce_to("bad"), (Texts{"a=1", "c=1", "B=online"}));
  now_ += Suspects::kFirstHold;
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
  EXPECT_EQ(announce_to(""), (Texts{"a=1", "bad=1", "c=1", "B=online"}));
  EXPECT_TRUE(said_.empty());
}

TEST_F(TrafficTest, OneThatIsNeverAcknowledgedHoldsUpAllElseOnce) {
  (void)announce_to("bad");
  begin();
  push({value("bad", "1"), value("c", "1")});
  EXPECT_EQ(send().size(), 1U);
  now_ += Traffic::kStalled + 3ms;
  EXPECT_TRUE(traffic_.stalled(now_));
  traffic_.end(false, now_);
  begin();
  push({value("bad", "1"), value("c", "1")});
  EXPECT_EQ(send().size(), 2U);
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
