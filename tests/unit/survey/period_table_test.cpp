#include "canopen/survey/period_table.h"

#include <gtest/gtest.h>

namespace canopen {
namespace {

using namespace std::chrono_literals;

constexpr std::uint32_t kTpdo = 0x185;

class PeriodTableTest : public testing::Test {
 protected:
  void hear(std::uint32_t cob_id, Duration after) {
    moment_.at += after;
    table_.hear(cob_id, moment_);
  }
  PeriodTable table_;
  Moment moment_{.at = TimePoint(1h), .hour = 1, .unbroken = 1};
};

TEST_F(PeriodTableTest, TellsTheWorstExactly) {
  hear(kTpdo, 0ms);
  for (int i = 0; i < 200; ++i) {
    hear(kTpdo, i == 77 ? 123ms : 10ms);
  }
  const std::vector<PeriodHealth> told = table_.of_day(1);
  ASSERT_EQ(told.size(), 1U);
  EXPECT_EQ(told[0].cob_id, kTpdo);
  EXPECT_EQ(told[0].period.count, 200U);
  EXPECT_LE(told[0].period.p99, told[0].worst);
  EXPECT_NEAR(static_cast<double>(told[0].period.p50.count()), 10e6, 10e6 / 16);
  EXPECT_NEAR(static_cast<double>(told[0].worst.count()), 123e6, 2e3);
}

TEST_F(PeriodTableTest, OneFrameHasNoPeriod) {
  hear(kTpdo, 0ms);
  EXPECT_TRUE(table_.of_day(1).empty());
}

TEST_F(PeriodTableTest, AGapInWhichFramesWereLostIsNotTheDrives) {
  hear(kTpdo, 0ms);
  hear(kTpdo, 10ms);
  ++moment_.unbroken;
  hear(kTpdo, 5s);
  hear(kTpdo, 10ms);
  const std::vector<PeriodHealth> told = table_.of_day(1);
  ASSERT_EQ(told.size(), 1U);
  EXPECT_EQ(told[0].period.count, 2U);
  EXPECT_LT(told[0].worst, 11ms);
}

TEST_F(PeriodTableTest, AcrossABreakOfItsNodeThereIsNoPeriod) {
  constexpr std::uint32_t kOfAnother = 0x186;
  hear(kTpdo, 0ms);
  hear(kOfAnother, 0ms);
  table_.break_node(5);
  hear(kTpdo, 10h);
  hear(kOfAnother, 0ms);
  hear(kTpdo, 10ms);
  const std::vector<PeriodHealth> told = table_.of_day(1);
  ASSERT_EQ(told.size(), 2U);
  EXPECT_EQ(told[0].period.count, 1U);
  EXPECT_LT(told[0].worst, 11ms);
  EXPECT_GT(told[1].worst, 1h) << "its node had no break";
}

TEST_F(PeriodTableTest, WhatComesWhenItLikesHasNoPeriod) {
  for (const std::uint32_t cob_id : {0x000U, 0x085U, 0x585U, 0x605U, 0x800U, 0x1FFFFFFFU}) {
    hear(cob_id, 1ms);
    hear(cob_id, 1ms);
  }
  EXPECT_TRUE(table_.of_day(1).empty());
  for (const std::uint32_t cob_id : {0x080U, 0x100U, 0x181U, 0x580U, 0x680U, 0x705U, 0x7FFU}) {
    hear(cob_id, 1ms);
    hear(cob_id, 1ms);
  }
  EXPECT_EQ(table_.of_day(1).size(), 7U);
}

TEST_F(PeriodTableTest, TheWorstIsForgottenAfterADay) {
  hear(kTpdo, 0ms);
  hear(kTpdo, 3s);
  for (moment_.hour = 2; moment_.hour <= 26; ++moment_.hour) {
    hear(kTpdo, 10ms);
    ASSERT_EQ(table_.of_day(moment_.hour)[0].worst > 2s, moment_.hour <= 25) << moment_.hour;
  }
}

}  // namespace
}  // namespace canopen
