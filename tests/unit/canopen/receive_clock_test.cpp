#include "canopen/bus/socketcan/receive_clock.h"

#include <gtest/gtest.h>

namespace canopen::socketcan {
namespace {

using namespace std::chrono_literals;

/// The two clocks of a machine, and the stamps the kernel gives.
class ReceiveClockTest : public testing::Test {
 protected:
  ReceiveClockTest() { clock_.start(now_); }

  void pass(Duration time) {
    now_ += time;
    wall_ += time;
  }
  void read() { clock_.set(now_, wall_); }

  TimePoint now_{1h};
  WallTime wall_{std::chrono::sys_days(std::chrono::year(2026) / 1 / 2)};
  ReceiveClock clock_;
};

TEST_F(ReceiveClockTest, AFrameIsAsOldAsItsStamp) {
  const TimePoint received = now_ + 10ms;
  pass(10ms);
  const WallTime stamp = wall_;
  pass(1450ms);
  read();
  EXPECT_EQ(clock_.at(stamp), received);
  EXPECT_EQ(clock_.at(stamp + 1s), received + 1s);
  EXPECT_EQ(clock_.heard_until(), received + 1s);
}

TEST_F(ReceiveClockTest, NothingIsReceivedInTheFutureOrBeforeItsPredecessor) {
  pass(1s);
  read();
  EXPECT_EQ(clock_.at(wall_ + 1us), now_);
  EXPECT_EQ(clock_.at(wall_ - 20ms), now_) << "disorder";
  pass(1s);
  read();
  EXPECT_EQ(clock_.at(wall_ - 500ms), now_ - 500ms);
}

TEST_F(ReceiveClockTest, NothingIsReceivedBeforeTheSocketWasOpened) {
  const TimePoint opened = now_;
  pass(5ms);
  read();
  EXPECT_EQ(clock_.at(wall_ - 6ms), opened);
}

// The time of day is set while frames wait: those from before are stamped by another clock than the one that is read.
class SteppedWallClock : public ReceiveClockTest, public testing::WithParamInterface<std::chrono::milliseconds> {};

TEST_P(SteppedWallClock, MovesNoReceiveTimeBeyondTheStall) {
  pass(10ms);
  read();
  const TimePoint before = clock_.at(wall_);
  pass(500ms);
  const WallTime first = wall_;
  pass(500ms);
  wall_ += GetParam();
  const WallTime second = wall_;
  pass(500ms);
  read();
  const TimePoint first_at = clock_.at(first);
  const TimePoint second_at = clock_.at(second);
  EXPECT_GE(first_at, before);
  EXPECT_GE(second_at, first_at);
  EXPECT_LE(second_at, now_);
  // The next ones are stamped by the clock that is read.
  pass(100ms);
  read();
  EXPECT_EQ(clock_.at(wall_ - 10ms), now_ - 10ms);
}

INSTANTIATE_TEST_SUITE_P(By, SteppedWallClock, testing::Values(-86'400'000ms, -10'000ms, -300ms, 300ms, 10'000ms),
                         [](const auto& parameter) {
                           const auto by = parameter.param.count();
                           return (by < 0 ? "Minus" : "Plus") + std::to_string(by < 0 ? -by : by);
                         });

TEST_F(ReceiveClockTest, AStepBetweenTwoBatchesMovesNothing) {
  for (const auto step : {10s, -10s, 3600s}) {
    wall_ += step;
    pass(20ms);
    read();
    EXPECT_EQ(clock_.at(wall_ - 3ms), now_ - 3ms);
  }
}

TEST_F(ReceiveClockTest, AnImplausibleStampCountsAsNowAndProvesNothing) {
  pass(2s);
  read();
  const TimePoint heard = clock_.heard_until();
  EXPECT_EQ(clock_.at(wall_ - 1h), now_);
  EXPECT_EQ(clock_.heard_until(), heard) << "frames behind it may be as old as the socket";
}

}  // namespace
}  // namespace canopen::socketcan
