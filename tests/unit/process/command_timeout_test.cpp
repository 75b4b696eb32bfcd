// When the silence of a writer makes the gateway act: each row is a course of 1 s steps, with a timeout of 3 s.

#include "bridges/process/command_timeout.h"

#include <gtest/gtest.h>

#include <chrono>
#include <string>

#include "tests/unit/process/control_cases.h"

namespace process {
namespace {

using namespace std::chrono_literals;

/// One letter is one thing that happens at its second:
///   A B  a run command of the PLC, of MQTT, accepted and confirmed     J K  accepted only     L  MQTT's is confirmed
///   S T  a stop likewise                                               p q  a set-point of the PLC, of MQTT, accepted
///   a b  a sign of life of the PLC, of MQTT                            m    a fault reset of the PLC
///   r u  the drive is taken over: it runs, nobody knows                1 0  running, not running
///   + -  the timeout's values are confirmed, failed                    s    confirmed, and they are a stop
///   e    the session ends                                              .    nothing
/// The result tells for each second: `.` it has not acted, `!` it has, `C` and it ceases, `W` and it writes values.
struct TimeoutCase {
  std::string name;
  OnTimeout on_timeout;
  std::string course;
  std::string result;
};

class TimeoutCourse {
 public:
  TimeoutCourse(canopen::Duration timeout, OnTimeout on_timeout) : timeout_(timeout, on_timeout) {}

  std::string run(const std::string& course) {
    std::string result;
    for (const char what : course) {
      happen(what);
      result += step();
      now_ += 1s;
    }
    return result;
  }
  [[nodiscard]] CommandTimeout& timeout() noexcept { return timeout_; }
  [[nodiscard]] canopen::TimePoint now() const noexcept { return now_; }

 private:
  void give(const Writer& writer, ControlUse use) {
    timeout_.on_accepted(writer, use, now_);
    timeout_.on_confirmed(writer, use, now_);
  }
  char step() {
    CommandTimeout::Action action = CommandTimeout::Action::none;
    if (now_ >= timeout_.next_time()) {
      action = timeout_.expire(now_);
    }
    switch (action) {
      case CommandTimeout::Action::cease:
        return 'C';
      case CommandTimeout::Action::write_values:
        return 'W';
      case CommandTimeout::Action::none:
        break;
    }
    return timeout_.acted() ? '!' : '.';
  }
  void happen(char what) {
    if (!happened_to_drive(what) && !happened_to_writer(what)) {
      EXPECT_EQ(what, '.');
    }
  }
  bool happened_to_writer(char what) {
    switch (what) {
      case 'A':
        return give(test::kPlc, ControlUse::run), true;
      case 'B':
        return give(test::kMqtt, ControlUse::run), true;
      case 'S':
        return give(test::kPlc, ControlUse::stop), true;
      case 'T':
        return give(test::kMqtt, ControlUse::stop), true;
      case 'm':
        return give(test::kPlc, ControlUse::momentary), true;
      case 'J':
        return timeout_.on_accepted(test::kPlc, ControlUse::run, now_), true;
      case 'K':
        return timeout_.on_accepted(test::kMqtt, ControlUse::run, now_), true;
      case 'L':
        return timeout_.on_confirmed(test::kMqtt, ControlUse::run, now_), true;
      case 'p':
        return timeout_.on_accepted(test::kPlc, ControlUse::none, now_), true;
      case 'q':
        return timeout_.on_accepted(test::kMqtt, ControlUse::none, now_), true;
      case 'a':
        return timeout_.on_sign_of_life(test::kPlc, now_), true;
      case 'b':
        return timeout_.on_sign_of_life(test::kMqtt, now_), true;
      default:
        return false;
    }
  }
  bool happened_to_drive(char what) {
    switch (what) {
      case 'r':
        return timeout_.on_taken_over(true, now_), true;
      case 'u':
        return timeout_.on_taken_over(std::nullopt, now_), true;
      case '1':
        return timeout_.on_running(true), true;
      case '0':
        return timeout_.on_running(false), true;
      case 'e':
        return timeout_.on_session_end(), true;
      case '+':
        return timeout_.on_values_confirmed(), true;
      case 's':
        timeout_.on_confirmed(test::kLocal, ControlUse::stop, now_);
        return timeout_.on_values_confirmed(), true;
      case '-':
        return timeout_.on_values_failed("refused by the drive", now_), true;
      default:
        return false;
    }
  }

  CommandTimeout timeout_;
  canopen::TimePoint now_{1h};
};

class TimeoutCases : public testing::TestWithParam<TimeoutCase> {};

TEST_P(TimeoutCases, ActsAndEnds) {
  TimeoutCourse course(3s, GetParam().on_timeout);
  EXPECT_EQ(course.run(GetParam().course), GetParam().result);
}

INSTANTIATE_TEST_SUITE_P(
    WhoseSilence, TimeoutCases,
    testing::Values(TimeoutCase{"NobodyCommanded", OnTimeout::hold, "ab......", "........"},
                    TimeoutCase{"Silent", OnTimeout::hold, "A......", "...!!!!"},
                    TimeoutCase{"OwnSignsOfLife", OnTimeout::hold, "A.a..a..p....", "...........!!"},
                    TimeoutCase{"SignsOfOthersDoNotHelp", OnTimeout::hold, "A.b.q.b", "...!!!!"},
                    TimeoutCase{"TheLastConfirmedWriterCounts", OnTimeout::hold, "A.B.a.a", ".....!!"},
                    TimeoutCase{"NotOneWhoseCommandIsNotConfirmed", OnTimeout::hold, "A.K.b.b", "...!!!!"},
                    TimeoutCase{"FromTheAcceptanceNotTheConfirmation", OnTimeout::hold, "K.L....", "...!!!!"},
                    TimeoutCase{"SignsBeforeTheConfirmationCount", OnTimeout::hold, "K.bL....", ".....!!!"},
                    TimeoutCase{"ConfirmedWhenItsWriterWasSilentTooLong", OnTimeout::hold, "K...A.L", "......!"},
                    TimeoutCase{"StopIsNotWatched", OnTimeout::hold, "A.S.....", "........"},
                    TimeoutCase{"StopOfAnotherIsNotWatched", OnTimeout::hold, "A.T.....", "........"},
                    TimeoutCase{"AStandstillIsNoStop", OnTimeout::hold, "A10....", "...!!!!"},
                    TimeoutCase{"FaultResetIsNoStop", OnTimeout::hold, "m....", "...!!"},
                    TimeoutCase{"SetPointsAloneAreNotWatched", OnTimeout::hold, "p.....", "......"},
                    TimeoutCase{"SessionEnds", OnTimeout::hold, "A.e.....", "........"}),
    test::row_name<TimeoutCase>);

INSTANTIATE_TEST_SUITE_P(
    Takeover, TimeoutCases,
    testing::Values(TimeoutCase{"Running", OnTimeout::hold, "r.....", "...!!!"},
                    TimeoutCase{"AnyWriterLives", OnTimeout::hold, "r.a.b.q....", ".........!!"},
                    TimeoutCase{"KnownToRunLater", OnTimeout::hold, "u.1...", "...!!!"},
                    TimeoutCase{"FoundStanding", OnTimeout::hold, "u.0..1..", "........"},
                    TimeoutCase{"NobodyKnows", OnTimeout::hold, "u.......", "........"},
                    TimeoutCase{"ComesToAStop", OnTimeout::hold, "r.0.....", "........"},
                    TimeoutCase{"AWriterTakesCharge", OnTimeout::hold, "r.A.b.b", ".....!!"},
                    TimeoutCase{"LostAgain", OnTimeout::hold, "r.e.....", "........"},
                    TimeoutCase{"AWriterTookChargeBeforeItWasKnownToRun", OnTimeout::hold, "u.A1b...", ".....!!!"},
                    TimeoutCase{"LostBeforeItWasKnownToRun", OnTimeout::hold, "ue1.....", "........"},
                    TimeoutCase{"BackBeforeItActed", OnTimeout::hold, "A.er....", "......!!"},
                    TimeoutCase{"BackAfterItActed", OnTimeout::cease, "A...er.......", "...C!!!!!!!!!"}),
    test::row_name<TimeoutCase>);

INSTANTIATE_TEST_SUITE_P(
    End, TimeoutCases,
    testing::Values(
        TimeoutCase{"SignsOfLifeEndNothing", OnTimeout::hold, "A...ab.a", "...!!!!!"},
        TimeoutCase{"SetPointsEndNothing", OnTimeout::hold, "A...p.q.", "...!!!!!"},
        TimeoutCase{"NorDoesTheEndOfTheSession", OnTimeout::hold, "A...e...", "...!!!!!"},
        TimeoutCase{"AcceptedCommandEndsIt", OnTimeout::hold, "A....B..b", "...!!...."},
        TimeoutCase{"StopEndsIt", OnTimeout::hold, "A....T......", "...!!......."},
        TimeoutCase{"WhoEndedItIsWatchedThoughHisCommandFailed", OnTimeout::hold, "A....K.a..b", "...!!...!!!"},
        TimeoutCase{"NobodyIsWatchedWhereTheDriveHoldsAStop", OnTimeout::values, "A...sK......", "...W!......."},
        TimeoutCase{"NorWhereItWasTakenOverAndStopped", OnTimeout::cease, "A...er0K....", "...C!!!....."},
        TimeoutCase{"ButWhereItStillRuns", OnTimeout::cease, "A...er.K....", "...C!!!...C!"},
        TimeoutCase{"EarlierCommandConfirmedLate", OnTimeout::cease, "A.K.L...", "...C!C!!"}),
    test::row_name<TimeoutCase>);

INSTANTIATE_TEST_SUITE_P(
    Actions, TimeoutCases,
    testing::Values(TimeoutCase{"HoldShowsOnly", OnTimeout::hold, "A.....", "...!!!"},
                    TimeoutCase{"CeaseOnce", OnTimeout::cease, "A.....", "...C!!"},
                    TimeoutCase{"CeaseAgainForTheNext", OnTimeout::cease, "A....B....", "...C!...C!"},
                    TimeoutCase{"ValuesOnceWhereConfirmed", OnTimeout::values, "A...+...", "...W!!!!"},
                    TimeoutCase{"ValuesEachSecondWhereNot", OnTimeout::values, "A...---+...", "...WWWW!!!!"},
                    TimeoutCase{"NotWhileTheLastIsNotAnswered", OnTimeout::values, "A.....-.+..", "...W!!W!!!!"},
                    TimeoutCase{"UntilACommandIsAccepted", OnTimeout::values, "A...-B.b.b", "...WW....."},
                    TimeoutCase{"ThoughTheLastAttemptIsAnsweredLater", OnTimeout::values, "A...-J-a.a", "...WW....."},
                    TimeoutCase{"NotUntilASetPointIsAccepted", OnTimeout::values, "A...-p-+", "...WW!W!"},
                    TimeoutCase{"GivenUpWithTheSession", OnTimeout::values, "A...-e-...", "...WW!!!!!"},
                    TimeoutCase{"NoValuesForADriveThatComesBack", OnTimeout::values, "A...-e-r.1....",
                                "...WW!!!!!!!!!"},
                    TimeoutCase{"LateFailureIsNotOfTheNextTime", OnTimeout::values, "A....B....-+.", "...W!...!!W!!"},
                    TimeoutCase{"NorIsALateConfirmation", OnTimeout::values, "A....B....+.-+.", "...W!...!!W!W!!"}),
    test::row_name<TimeoutCase>);

TEST(CommandTimeout, WithoutTimeNothingIsWatched) {
  TimeoutCourse course(0s, OnTimeout::values);
  EXPECT_EQ(course.run("A.....r.u1...e"), "..............");
  EXPECT_EQ(course.timeout().next_time(), canopen::kNever);
}

TEST(CommandTimeout, TellsWhoseSilenceItWouldActOn) {
  const Writer mqtt{.way = Writer::Way::mqtt, .address = {}};
  const Writer plc{.way = Writer::Way::modbus, .address = "192.0.2.7"};
  const canopen::TimePoint now(1h);
  CommandTimeout timeout(3s, OnTimeout::hold);
  EXPECT_FALSE(timeout.counts_on(mqtt));
  timeout.on_accepted(mqtt, ControlUse::run, now);
  timeout.on_confirmed(mqtt, ControlUse::run, now);
  EXPECT_TRUE(timeout.counts_on(mqtt));
  EXPECT_FALSE(timeout.counts_on(plc));
  timeout.on_accepted(mqtt, ControlUse::stop, now);
  timeout.on_confirmed(mqtt, ControlUse::stop, now);
  EXPECT_FALSE(timeout.counts_on(mqtt));
  timeout.on_taken_over(true, now);
  EXPECT_TRUE(timeout.counts_on(mqtt)) << "of any writer";
  EXPECT_TRUE(timeout.counts_on(plc));
  timeout.on_session_end();
  EXPECT_FALSE(timeout.counts_on(mqtt));
}

TEST(CommandTimeout, NextTimeIsTheEndOfTheSilenceThenTheNextAttempt) {
  TimeoutCourse course(2500ms, OnTimeout::values);
  const auto start = course.now();
  course.run("A.a");
  EXPECT_EQ(course.timeout().next_time(), start + 4500ms);
  EXPECT_EQ(course.timeout().expire(start + 4499ms), CommandTimeout::Action::none);
  EXPECT_FALSE(course.timeout().acted());
  EXPECT_EQ(course.timeout().expire(start + 4500ms), CommandTimeout::Action::write_values);
  EXPECT_EQ(course.timeout().next_time(), canopen::kNever) << "not before it is answered";
  course.timeout().on_values_failed("no answer", start + 4700ms);
  EXPECT_EQ(course.timeout().next_time(), start + 5500ms);
  EXPECT_EQ(course.timeout().expire(start + 5499ms), CommandTimeout::Action::none);
  EXPECT_EQ(course.timeout().expire(start + 5500ms), CommandTimeout::Action::write_values);
}

TEST(CommandTimeout, AfterAStandstillOfTheProcessWhatWaitsIsReadFirst) {
  TimeoutCourse course(2s, OnTimeout::cease);
  const auto start = course.now();
  course.run("A");
  EXPECT_EQ(course.timeout().expire(start + 5s), CommandTimeout::Action::none);
  EXPECT_FALSE(course.timeout().acted());
  const auto again = course.timeout().next_time();
  EXPECT_GT(again, start + 5s);
  EXPECT_LE(again, start + 5100ms);

  TimeoutCourse lives = course;
  lives.timeout().on_sign_of_life(test::kPlc, start + 5s);
  EXPECT_EQ(lives.timeout().next_time(), start + 7s);
  EXPECT_EQ(lives.timeout().expire(again), CommandTimeout::Action::none);
  EXPECT_FALSE(lives.timeout().acted());

  EXPECT_EQ(course.timeout().expire(start + 9s), CommandTimeout::Action::cease) << "once only, however late";
}

std::string timeout_alarm_after(OnTimeout on_timeout, const std::string& course) {
  TimeoutCourse played(2s, on_timeout);
  played.run(course);
  const auto alarm = played.timeout().alarm();
  return alarm ? std::string(name_of(alarm->reason)) + ": " + alarm->text : "";
}

TEST(CommandTimeout, AlarmSaysWhoseSilenceAndWhatBecameOfIt) {
  EXPECT_EQ(timeout_alarm_after(OnTimeout::hold, "A."), "");
  EXPECT_EQ(timeout_alarm_after(OnTimeout::hold, "A.."),
            "timeout: no sign of life of modbus 192.0.2.7 for 2s: the drive goes on");
  EXPECT_EQ(timeout_alarm_after(OnTimeout::cease, "B.."),
            "timeout: no sign of life of mqtt for 2s: RPDOs are repeated no more");
  EXPECT_EQ(timeout_alarm_after(OnTimeout::hold, "r.."),
            "timeout: no sign of life of any writer for 2s: the drive goes on");
  const std::string silence = "no sign of life of modbus 192.0.2.7 for 2s: ";
  EXPECT_EQ(timeout_alarm_after(OnTimeout::values, "A.."), "timeout: " + silence + "its values are being written");
  EXPECT_EQ(timeout_alarm_after(OnTimeout::values, "A..+"), "timeout: " + silence + "its values were written");
  EXPECT_EQ(timeout_alarm_after(OnTimeout::values, "A..-"),
            "timeout-failed: " + silence + "its values are not confirmed: refused by the drive");
  EXPECT_EQ(timeout_alarm_after(OnTimeout::values, "A..-+"), "timeout: " + silence + "its values were written");
  const std::string given_up =
      "its values are not confirmed, and given up since the drive was lost or left operational";
  EXPECT_EQ(timeout_alarm_after(OnTimeout::values, "A..e"), "timeout-failed: " + silence + given_up);
  EXPECT_EQ(timeout_alarm_after(OnTimeout::values, "A..-e"), "timeout-failed: " + silence + given_up);
  EXPECT_EQ(timeout_alarm_after(OnTimeout::values, "A..+e"), "timeout: " + silence + "its values were written");
  EXPECT_EQ(timeout_alarm_after(OnTimeout::values, "A..-J"), "");
  EXPECT_EQ(timeout_alarm_after(OnTimeout::values, "A..-J-.."), "timeout: " + silence + "its values are being written")
      << "the next";
}

}  // namespace
}  // namespace process
