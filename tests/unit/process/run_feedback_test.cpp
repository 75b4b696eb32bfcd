// Whether the motor follows a run command: each row is a course of 1 s steps, with 2 s to follow.

#include "bridges/process/run_feedback.h"

#include <gtest/gtest.h>

#include <chrono>
#include <string>

#include "tests/unit/process/control_cases.h"

namespace process {
namespace {

using namespace std::chrono_literals;

/// One letter is one thing that happens at its second, `.` nothing: `r` a confirmed run command, `s` a confirmed stop,
/// `m` a momentary value, `p` a set-point, `1` running, `0` not running, `?` nobody knows, `e` the session ends. The
/// result has `!` for each second after which the failure stands.
struct FeedbackCase {
  std::string name;
  std::string course;
  std::string failed;
};

void tell_feedback(RunFeedback& feedback, char what, canopen::TimePoint now) {
  switch (what) {
    case 'r':
      return feedback.on_confirmed(ControlUse::run, now);
    case 's':
      return feedback.on_confirmed(ControlUse::stop, now);
    case 'm':
      return feedback.on_confirmed(ControlUse::momentary, now);
    case 'p':
      return feedback.on_confirmed(ControlUse::none, now);
    case '1':
      return feedback.on_running(true, now);
    case '0':
      return feedback.on_running(false, now);
    case '?':
      return feedback.on_running(std::nullopt, now);
    case 'e':
      return feedback.on_session_end();
    default:
      EXPECT_EQ(what, '.');
  }
}

std::string feedback_course(RunFeedback& feedback, const std::string& course) {
  std::string failed;
  canopen::TimePoint now{1h};
  for (const char what : course) {
    tell_feedback(feedback, what, now);
    if (now >= feedback.next_time()) {
      feedback.expire(now);
    }
    failed += feedback.failed() ? '!' : '.';
    now += 1s;
  }
  return failed;
}

class RunFeedbackCases : public testing::TestWithParam<FeedbackCase> {};

TEST_P(RunFeedbackCases, FailsAndEnds) {
  RunFeedback feedback(2s);
  EXPECT_EQ(feedback_course(feedback, GetParam().course), GetParam().failed);
}

INSTANTIATE_TEST_SUITE_P(Courses, RunFeedbackCases,
                         testing::Values(FeedbackCase{"NeverRuns", "0r....", "...!!!"},                   //
                                         FeedbackCase{"RunsInTime", "0r1...", "......"},                  //
                                         FeedbackCase{"RunsTooLate", "0r..1.", "...!.."},                 //
                                         FeedbackCase{"StoppedBeforeItIsDue", "0rs....", "......."},      //
                                         FeedbackCase{"StopEndsIt", "0r..s.", "...!.."},                  //
                                         FeedbackCase{"SessionEndsIt", "0r..e.", "...!.."},               //
                                         FeedbackCase{"SessionEndsBefore", "0re....", "......."},         //
                                         FeedbackCase{"RepeatedRunGivesNoMoreTime", "0rrrrr", "...!!!"},  //
                                         FeedbackCase{"SetPointsAndMomentary", "0mp...", "......"},       //
                                         FeedbackCase{"SetPointDoesNotEndIt", "0r.pm.", "...!!!"},        //
                                         FeedbackCase{"NobodyKnows", "?r....0.1", "......!!."},           //
                                         FeedbackCase{"KnownTooLateAndRunning", "?r....1.", "........"},  //
                                         FeedbackCase{"StillRunningDown", "1r..0..", "......."},          //
                                         FeedbackCase{"RanDownAndDidNotFollow", "1r0....", "...!!!!"},    //
                                         FeedbackCase{"AgainAfterItsEnd", "0r..s.r...", "...!....!!"},    //
                                         FeedbackCase{"StoppedItselfAndRunRepeated", "0r1.0.r...", "........!!"}),
                         test::row_name<FeedbackCase>);

TEST(RunFeedback, WithoutTimeNothingIsAwaited) {
  RunFeedback feedback(0s);
  EXPECT_EQ(feedback_course(feedback, "0r......"), "........");
  EXPECT_EQ(feedback.next_time(), canopen::kNever);
}

}  // namespace
}  // namespace process
