#include "canopen/node/doubled_id.h"

#include <gtest/gtest.h>

namespace canopen {
namespace {

using namespace std::chrono_literals;

constexpr NmtState kOperational = NmtState::operational;
constexpr NmtState kPreOperational = NmtState::pre_operational;

class DoubledIdTest : public testing::Test {
 protected:
  DoubledIdTest() { id_.set_rate(500ms); }
  void heartbeats(NmtState state, int count, Duration period) {
    for (int i = 0; i < count; ++i) {
      now_ += period;
      id_.on_heartbeat(state, now_);
    }
  }
  DoubledId id_{500ms};
  TimePoint now_{1h};
};

TEST_F(DoubledIdTest, OneDriveIsNone) {
  id_.on_boot_up(now_);
  heartbeats(kPreOperational, 3, 500ms);
  id_.on_nmt(NmtCommand::start, now_ + 100ms);
  heartbeats(kOperational, 100, 500ms);
  id_.on_nmt(NmtCommand::stop, now_ + 100ms);
  heartbeats(NmtState::stopped, 1, 500ms);
  id_.on_nmt(NmtCommand::start, now_ + 100ms);
  heartbeats(kOperational, 100, 500ms);
  EXPECT_EQ(id_.verdict(), Doubled::no);
  EXPECT_EQ(id_.next(), kNever);
}

TEST_F(DoubledIdTest, ThereAndBackWithinTwoPeriodsIsProof) {
  heartbeats(kOperational, 5, 500ms);
  heartbeats(kPreOperational, 1, 200ms);
  EXPECT_EQ(id_.verdict(), Doubled::no) << "it may have left operational";
  heartbeats(kOperational, 1, 300ms);
  EXPECT_EQ(id_.verdict(), Doubled::proof);
  EXPECT_EQ(id_.text(),
            "its heartbeat goes from operational to pre-operational and back within two periods, and nobody commanded "
            "it");
}

TEST_F(DoubledIdTest, ThereAndBackInLongerIsADriveThatLeftAndCameBack) {
  heartbeats(kOperational, 5, 500ms);
  heartbeats(kPreOperational, 2, 500ms);
  heartbeats(kOperational, 5, 500ms);
  EXPECT_EQ(id_.verdict(), Doubled::no);
}

TEST_F(DoubledIdTest, ThereAndBackByCommandIsNone) {
  heartbeats(kOperational, 5, 500ms);
  id_.on_nmt(NmtCommand::pre_operational, now_ + 10ms);
  heartbeats(kPreOperational, 1, 200ms);
  id_.on_nmt(NmtCommand::start, now_ + 10ms);
  heartbeats(kOperational, 1, 300ms);
  EXPECT_EQ(id_.verdict(), Doubled::no);
}

TEST_F(DoubledIdTest, TwoBootUpsWithinOnePeriodAreProof) {
  id_.on_boot_up(now_);
  id_.on_boot_up(now_ + 499ms);
  EXPECT_EQ(id_.verdict(), Doubled::proof);
  EXPECT_EQ(id_.text(), "two boot-ups within one heartbeat period, and nobody reset it");
}

TEST_F(DoubledIdTest, TwoBootUpsAfterAResetOrFarApartAreNone) {
  id_.on_boot_up(now_);
  id_.on_boot_up(now_ + 501ms);
  EXPECT_EQ(id_.verdict(), Doubled::no);
  id_.on_nmt(NmtCommand::reset_node, now_ + 1s);
  id_.on_boot_up(now_ + 3s);
  id_.on_boot_up(now_ + 3100ms);
  EXPECT_EQ(id_.verdict(), Doubled::no);
}

TEST_F(DoubledIdTest, HeartbeatsAtTwiceTheirRateAreAHint) {
  for (int i = 0; i < 8; ++i) {
    heartbeats(kOperational, 1, 100ms);
    heartbeats(kOperational, 1, 400ms);
  }
  EXPECT_EQ(id_.verdict(), Doubled::hint);
  EXPECT_EQ(id_.text(), "its heartbeats come twice as often as they should");
}

TEST_F(DoubledIdTest, JitterAShortBurstAndAShorterPeriodAreNoHint) {
  for (int i = 0; i < 50; ++i) {
    heartbeats(kOperational, 1, 300ms);
    heartbeats(kOperational, 1, 700ms);
  }
  heartbeats(kOperational, 20, 500ms);
  heartbeats(kOperational, 6, 1ms);
  heartbeats(kOperational, 20, 500ms);
  heartbeats(kOperational, 50, 350ms);
  EXPECT_EQ(id_.verdict(), Doubled::no);
}

TEST_F(DoubledIdTest, WithoutAPeriodTimesTellNothing) {
  id_ = DoubledId(0ms);
  id_.on_boot_up(now_);
  id_.on_boot_up(now_ + 50ms);
  heartbeats(kOperational, 40, 1ms);
  heartbeats(kPreOperational, 1, 1ms);
  heartbeats(kOperational, 1, 1ms);
  EXPECT_EQ(id_.verdict(), Doubled::no);
}

TEST_F(DoubledIdTest, SecondAnswersAreAHintAndAnotherOneIsProof) {
  id_.on_second_answer(false, now_ - 1min);
  id_.on_second_answer(false, now_);
  EXPECT_EQ(id_.verdict(), Doubled::no) << "CAN may double a frame now and then";
  id_.on_second_answer(false, now_ + 59s);
  EXPECT_EQ(id_.verdict(), Doubled::hint);
  id_.on_second_answer(true, now_);
  EXPECT_EQ(id_.verdict(), Doubled::proof);
  EXPECT_EQ(id_.text(), "two different SDO answers came to one request");
}

TEST_F(DoubledIdTest, ABootUpFrameThatCanDoubledIsOne) {
  id_.on_boot_up(now_);
  id_.on_boot_up(now_ + 1ms);
  EXPECT_EQ(id_.verdict(), Doubled::no);
}

TEST_F(DoubledIdTest, ASelfStartingDriveMayGoThereAndBack) {
  id_ = DoubledId(500ms, true);
  heartbeats(kOperational, 1, 500ms);
  heartbeats(kPreOperational, 1, 100ms);
  heartbeats(kOperational, 1, 100ms);
  EXPECT_EQ(id_.verdict(), Doubled::hint);
}

TEST_F(DoubledIdTest, TheRateTellsNothingAfterABootUpUntilItIsReadAnew) {
  id_.on_boot_up(now_);
  heartbeats(kOperational, 40, 100ms);
  EXPECT_EQ(id_.verdict(), Doubled::no);
  id_.set_rate(500ms);
  heartbeats(kOperational, 40, 100ms);
  EXPECT_EQ(id_.verdict(), Doubled::hint);
}

TEST_F(DoubledIdTest, AHintKeepsAProofAlive) {
  id_.on_second_answer(true, now_);
  id_.on_doubled_tpdo(1, now_ + 50s);
  id_.look(now_ + 100s);
  EXPECT_EQ(id_.verdict(), Doubled::proof);
  id_.look(now_ + 110s);
  EXPECT_EQ(id_.verdict(), Doubled::no);
}

TEST_F(DoubledIdTest, AfterLostFramesNothingIsComparedWithWhatWasBefore) {
  heartbeats(kOperational, 1, 500ms);
  heartbeats(kPreOperational, 1, 100ms);
  id_.on_boot_up(now_);
  id_.on_frames_lost();
  id_.on_boot_up(now_ + 100ms);
  heartbeats(kPreOperational, 1, 10ms);
  id_.on_frames_lost();
  heartbeats(kOperational, 1, 10ms);
  EXPECT_EQ(id_.verdict(), Doubled::no);
}

TEST_F(DoubledIdTest, EndsAMinuteAfterTheLastSign) {
  id_.on_second_answer(true, now_);
  id_.on_doubled_tpdo(2, now_ + 10s);
  id_.on_second_answer(true, now_ + 30s);
  EXPECT_EQ(id_.next(), now_ + 70s);
  id_.look(now_ + 89s);
  EXPECT_EQ(id_.verdict(), Doubled::proof);
  EXPECT_EQ(id_.next(), now_ + 90s);
  id_.look(now_ + 90s);
  EXPECT_EQ(id_.verdict(), Doubled::no);
  EXPECT_TRUE(id_.text().empty());
}

TEST_F(DoubledIdTest, CommandsDoNotEndItButItsOwnerDoes) {
  id_.on_second_answer(true, now_);
  id_.on_nmt(NmtCommand::stop, now_);
  id_.on_nmt(NmtCommand::start, now_);
  EXPECT_EQ(id_.verdict(), Doubled::proof);
  id_.end();
  EXPECT_EQ(id_.verdict(), Doubled::no);
}

TEST_F(DoubledIdTest, WhatWasHeardBeforeItsEndIsNotCompared) {
  heartbeats(kOperational, 1, 500ms);
  heartbeats(kPreOperational, 1, 100ms);
  id_.end();
  heartbeats(kOperational, 1, 100ms);
  EXPECT_EQ(id_.verdict(), Doubled::no);
}

}  // namespace
}  // namespace canopen
