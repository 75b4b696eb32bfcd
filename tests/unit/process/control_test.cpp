// Lease, signs of life and feedback of one drive together, and what people see of them.

#include "bridges/process/control.h"

#include <gtest/gtest.h>

#include <chrono>

#include "tests/unit/process/control_cases.h"

namespace process {
namespace {

using namespace std::chrono_literals;

class ControlTest : public testing::Test {
 protected:
  /// Moves on to `at` since the start, calling expire() whenever it is asked for; the last action that was due.
  CommandTimeout::Action run_to(Control& control, canopen::Duration at) {
    auto last = CommandTimeout::Action::none;
    while (control.next_time() <= start_ + at) {
      const auto due = control.next_time();
      const auto action = control.expire(due);
      last = action == CommandTimeout::Action::none ? last : action;
      if (control.next_time() <= due) {
        ADD_FAILURE() << "expire() leaves something due";
        break;
      }
    }
    return last;
  }
  void give(Control& control, const Writer& writer, ControlUse use, canopen::Duration at) {
    ASSERT_FALSE(control.refuse(writer, use, start_ + at));
    control.on_accepted(writer, use, start_ + at);
    control.on_confirmed_control(writer, use, start_ + at);
  }

  canopen::ManualTime time_;
  canopen::TimePoint start_ = canopen::Clock::now();
};

TEST_F(ControlTest, NobodyAtFirst) {
  const Control control({.lease = 10s, .timeout = 2s, .feedback = 1s});
  EXPECT_EQ(control.state(), ControlState{});
  EXPECT_EQ(control.next_time(), canopen::kNever);
}

TEST_F(ControlTest, ReadingKeepsAMotorRunningButNobodyAway) {
  Control control({.lease = 5s, .timeout = 2s});
  give(control, test::kPlc, ControlUse::run, 0s);
  for (auto at = 1s; at <= 10s; ++at) {
    control.on_sign_of_life(test::kPlc, start_ + at);
    run_to(control, at);
  }
  EXPECT_FALSE(control.state().timeout);
  EXPECT_FALSE(control.state().holder) << "ended after 5 s without an accepted command";
  EXPECT_FALSE(control.refuse(test::kPanel, ControlUse::run, start_ + 10s));
}

TEST_F(ControlTest, RefusedCommandOfTheHolderIsASignOfLifeByItsRequestOnly) {
  Control control({.lease = 5s, .timeout = 2s, .on_timeout = OnTimeout::cease});
  give(control, test::kPlc, ControlUse::run, 0s);
  EXPECT_TRUE(control.refuse(test::kPanel, ControlUse::run, start_ + 1s));
  control.on_sign_of_life(test::kPanel, start_ + 1s);
  EXPECT_EQ(run_to(control, 2s), CommandTimeout::Action::cease);
  EXPECT_TRUE(control.state().timeout);
  EXPECT_EQ(control.state().holder, test::kPlc) << "his lease goes on";
}

TEST_F(ControlTest, LeaseIsShownFromTakingToItsEnd) {
  Control control({.lease = 5s});
  const auto wall = canopen::wall_now();
  give(control, test::kPlc, ControlUse::run, 0s);
  EXPECT_EQ(control.state(), (ControlState{.holder = test::kPlc, .since = wall, .timeout = false, .alarm = {}}));
  EXPECT_EQ(control.next_time(), start_ + 5s);
  run_to(control, 5s);
  EXPECT_EQ(control.state(), ControlState{});
}

TEST_F(ControlTest, ForeignStopEndsTheWatchAndTheHolderHasToStopHimself) {
  Control control({.lease = 1min, .timeout = 2s});
  give(control, test::kPlc, ControlUse::run, 0s);
  give(control, test::kPanel, ControlUse::stop, 1s);
  run_to(control, 30s);
  EXPECT_FALSE(control.state().timeout);
  EXPECT_TRUE(control.refuse(test::kPlc, ControlUse::run, start_ + 30s));
  give(control, test::kPlc, ControlUse::stop, 31s);
  give(control, test::kPlc, ControlUse::run, 32s);
}

TEST_F(ControlTest, LostDriveThatComesBackGetsNoValues) {
  Control control({.timeout = 2s, .on_timeout = OnTimeout::values});
  give(control, test::kPlc, ControlUse::run, 0s);
  EXPECT_EQ(run_to(control, 2s), CommandTimeout::Action::write_values);
  control.on_values_failed("no answer", start_ + 2500ms);
  control.on_session_end();
  EXPECT_EQ(run_to(control, 10s), CommandTimeout::Action::none);
  control.on_taken_over(true, start_ + 10s);
  control.on_running(true, start_ + 10s);
  EXPECT_EQ(run_to(control, 1h), CommandTimeout::Action::none);
  ASSERT_TRUE(control.state().alarm);
  EXPECT_EQ(control.state().alarm->reason, alarms::ControlReason::timeout_failed);
  give(control, test::kPlc, ControlUse::run, 2h);
  EXPECT_EQ(control.state(), ControlState{});
}

TEST_F(ControlTest, FeedbackIsAnAlarmUntilTheMotorRuns) {
  Control control({.feedback = 3s});
  control.on_running(false, start_);
  give(control, test::kPlc, ControlUse::run, 0s);
  run_to(control, 2999ms);
  EXPECT_FALSE(control.state().alarm);
  run_to(control, 3s);
  EXPECT_EQ(control.state().alarm,
            (alarms::ControlAlarm{.reason = alarms::ControlReason::feedback,
                                  .text = "running is still false 3s after a confirmed run command"}));
  EXPECT_FALSE(control.state().timeout);
  control.on_running(true, start_ + 4s);
  EXPECT_FALSE(control.state().alarm);
}

TEST_F(ControlTest, TimeoutGoesBeforeFeedback) {
  Control control({.timeout = 5s, .feedback = 3s});
  control.on_running(false, start_);
  give(control, test::kPlc, ControlUse::run, 0s);
  run_to(control, 5s);
  ASSERT_TRUE(control.state().alarm);
  EXPECT_EQ(control.state().alarm->reason, alarms::ControlReason::timeout);
  control.on_accepted(test::kPanel, ControlUse::run, start_ + 6s);
  ASSERT_TRUE(control.state().alarm);
  EXPECT_EQ(control.state().alarm->reason, alarms::ControlReason::feedback);
  control.on_session_end();
  EXPECT_FALSE(control.state().alarm);
}

}  // namespace
}  // namespace process
