#include "bridges/mqtt/traffic.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/unit/mqtt/traffic_fixture.h"

namespace mqtt {
namespace {

using namespace std::chrono_literals;
using test::TrafficTest;
using test::value;

TEST_F(TrafficTest, SendsNothingBeforeItIsOpenedAndNoMoreThanItsWindow) {
  traffic_.begin({.packet = 0, .window = 2}, 5, now_);
  push({value("a", "1"), value("b", "1"), value("c", "1")});
  EXPECT_TRUE(send().empty());
  traffic_.open();
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
  EXPECT_TRUE(traffic_.stalled(now_ + 3ms)) << "a few bytes take no longer";
  acknowledge(sent[0]);
  EXPECT_FALSE(traffic_.stalled(now_ + 1h)) << "nothing is under way";
}

TEST_F(TrafficTest, WhereThereIsAnotherBrokerLittleTimeIsLost) {
  for (int i = 0; i < 16; ++i) {
    push({value("v" + std::to_string(i), std::string(2000, 'x'))});
  }
  EXPECT_EQ(send().size(), 16U);
  now_ += Traffic::kStalledOfSeveral;
  EXPECT_FALSE(traffic_.stalled(now_, Traffic::kStalledOfSeveral));
  EXPECT_TRUE(traffic_.stalled(now_ + 600ms, Traffic::kStalledOfSeveral)) << "what lies behind the oldest has time yet";
}

TEST_F(TrafficTest, TellsWhenItIsToBeLookedAt) {
  EXPECT_EQ(traffic_.stalled_at(4s), Traffic::TimePoint::max()) << "nothing is under way";
  push({value("a", "1")});
  const auto sent = send();
  const auto at = traffic_.stalled_at(4s);
  EXPECT_FALSE(traffic_.stalled(at, 4s));
  EXPECT_TRUE(traffic_.stalled(at + 1ms, 4s));
  EXPECT_GE(at, now_ + 4s);
  EXPECT_LT(at, now_ + 4s + 10ms);
}

TEST_F(TrafficTest, ALongMessageHasTheTimeThatASlowLineTakes) {
  const std::size_t line = Traffic::kSlowestLine;
  push({value("long", std::string(100 * line, 'x')), value("a", "1")});
  const auto sent = send();
  ASSERT_EQ(sent.size(), 2U);
  now_ += 100s + Traffic::kStalled;
  EXPECT_FALSE(traffic_.stalled(now_));
  EXPECT_TRUE(traffic_.stalled(now_ + 1s)) << "but not for ever";
  acknowledge(sent[0]);
  EXPECT_FALSE(traffic_.stalled(now_ + Traffic::kStalled));
  EXPECT_TRUE(traffic_.stalled(now_ + Traffic::kStalled + 1s)) << "what is left is short";
}

TEST_F(TrafficTest, WhatCouldLeaveIsKnownUntilItDoes) {
  EXPECT_FALSE(traffic_.may_send(now_)) << "nothing waits";
  push({value("a", "1")});
  now_ += 1h;
  EXPECT_TRUE(traffic_.may_send(now_)) << "nobody has called next()";
  const auto sent = send();
  EXPECT_FALSE(traffic_.may_send(now_));
}

TEST_F(TrafficTest, NothingCouldLeaveBeforeItIsOpenedOrWhereTheWindowIsFull) {
  traffic_.begin({}, 5, now_);
  push({value("a", "1")});
  EXPECT_FALSE(traffic_.may_send(now_ + 1h)) << "it was not opened";
  begin({.packet = 0, .window = 1});
  push({value("b", "1")});
  const auto sent = send();
  EXPECT_FALSE(traffic_.may_send(now_ + 1h)) << "the window is full";
  traffic_.end(false, now_);
  EXPECT_FALSE(traffic_.may_send(now_ + 1h));
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

TEST_F(TrafficTest, WhatTheBrokerHasIsCounted) {
  push({value("a", "1"), value("b", "1"), value("c", "1")});
  const auto sent = send();
  acknowledge(sent.at(0));
  acknowledge(sent.at(1), Delivery::refused, 0x87);
  acknowledge(sent.at(2), Delivery::failed);
  EXPECT_EQ(traffic_.counts().published, 1U);
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

}  // namespace
}  // namespace mqtt
