#include "canopen/survey/node_table.h"

#include <gtest/gtest.h>

#include "tests/support/frame.h"

namespace canopen {
namespace {

using namespace std::chrono_literals;
using support::frame;

constexpr std::uint8_t kOneNode = 5;
constexpr std::uint8_t kOperationalState = 5;

class NodeTableTest : public testing::Test {
 protected:
  NodeTableTest() {
    table_.set_timeout(kOneNode, 2s);
    serve(true);
  }
  void serve(bool served) { table_.set_served(NodeSet().set(kOneNode, served)); }
  void heartbeat(Duration after, std::uint8_t state = kOperationalState) {
    moment_.at += after;
    table_.hear_error_control(kOneNode, frame(0x705, state), moment_);
  }
  void request(Duration after, bool ours = true, std::uint8_t first = 0x40) {
    moment_.at += after;
    table_.hear_request(kOneNode, frame(0x605, first), ours, moment_);
  }
  void answer(Duration after) {
    moment_.at += after;
    table_.hear_answer(kOneNode, moment_);
  }
  [[nodiscard]] NodeHealth told() const { return table_.of_day(moment_.hour).at(0); }

  NodeTable table_;
  Moment moment_{.at = TimePoint(1h), .hour = 1, .unbroken = 1};
};

TEST_F(NodeTableTest, TheMarginIsWhatTheLongestGapLeavesOfTheTimeout) {
  EXPECT_FALSE(told().worst_margin());
  heartbeat(0ms);
  EXPECT_FALSE(told().worst_margin()) << "one heartbeat is no gap";
  heartbeat(500ms);
  heartbeat(1500ms);
  heartbeat(1000ms);
  EXPECT_EQ(told().node, kOneNode);
  EXPECT_NEAR(told().worst_margin().value(), 0.25, 0.001);
  EXPECT_NEAR(told().best_margin().value(), 0.75, 0.001);
  heartbeat(9s);
  EXPECT_EQ(told().worst_margin(), 0.0) << "it was lost, and no margin is below zero";
}

TEST_F(NodeTableTest, ABootUpAndWhatIsBeforeItIsServedAreNoGaps) {
  heartbeat(0ms);
  heartbeat(500ms);
  heartbeat(60s, 0);  // It had no power.
  serve(false);
  heartbeat(5s);
  heartbeat(5s);  // As the drive had it before it was set up.
  serve(true);
  heartbeat(500ms);
  heartbeat(500ms);
  EXPECT_NEAR(told().worst_margin().value(), 0.75, 0.001);
}

TEST_F(NodeTableTest, AGapInWhichFramesWereLostIsNotTheDrives) {
  heartbeat(0ms);
  ++moment_.unbroken;
  heartbeat(1900ms);
  EXPECT_FALSE(told().worst_margin());
  heartbeat(500ms);
  EXPECT_NEAR(told().worst_margin().value(), 0.75, 0.001);
}

TEST_F(NodeTableTest, WithoutATimeoutThereIsNoMargin) {
  table_.set_timeout(kOneNode, 0s);
  heartbeat(0ms);
  heartbeat(500ms);
  EXPECT_FALSE(told().worst_margin());
  EXPECT_TRUE(told().longest_gap);
}

TEST_F(NodeTableTest, AnAnswerIsTimedFromItsRequest) {
  for (int i = 0; i < 100; ++i) {
    request(10ms);
    answer(i < 95 ? 2ms : 80ms);
  }
  EXPECT_EQ(told().answers.count, 100U);
  EXPECT_NEAR(static_cast<double>(told().answers.p50.count()), 2e6, 2e6 / 16);
  EXPECT_NEAR(static_cast<double>(told().answers.p99.count()), 80e6, 80e6 / 16);
}

TEST_F(NodeTableTest, WhatMayBeTheAnswerToSomethingElseIsNotTimed) {
  request(1ms, false);
  answer(2ms);  // To another client.
  request(1ms);
  request(1ms, false);
  answer(2ms);
  answer(2ms);  // Nobody asked.
  request(1ms);
  request(500ms, true, 0x80);  // We gave up.
  answer(2ms);
  request(1ms);
  ++moment_.unbroken;
  answer(2ms);
  EXPECT_EQ(told().answers.count, 0U);
  request(1ms);
  answer(2ms);
  EXPECT_EQ(told().answers.count, 1U);
}

TEST_F(NodeTableTest, TheWorstMarginIsForgottenAfterADay) {
  heartbeat(0ms);
  heartbeat(1800ms);
  for (moment_.hour = 2; moment_.hour <= 26; ++moment_.hour) {
    heartbeat(500ms);
    ASSERT_EQ(told().worst_margin().value() < 0.2, moment_.hour <= 25) << moment_.hour;
  }
}

TEST_F(NodeTableTest, OfWhomNothingIsKnownNothingIsTold) {
  EXPECT_EQ(table_.of_day(1).size(), 1U);
  table_.hear_error_control(77, frame(0x74D, kOperationalState), moment_);
  EXPECT_EQ(table_.of_day(1).size(), 1U) << "a stranger, whom nobody waits for";
}

}  // namespace
}  // namespace canopen
