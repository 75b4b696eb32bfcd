// When the silence of a writer makes the gateway act: each row is a course of 1 s steps, with a timeout of 3 s.

#include "bridges/process/command_timeout.h"

#include <gtest/gtest.h>

#include <chrono>
#include <string>

namespace process {
namespace {

using namespace std::chrono_literals;

const Writer kPlc{.way = Writer::Way::modbus, .address = "192.0.2.7"};
const Writer kMqtt{.way = Writer::Way::mqtt, .address = {}};
const Writer kLocal{.way = Writer::Way::local, .address = {}};

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

std::string name_of_case(const testing::TestParamInfo<TimeoutCase>& info) {
  return info.param.name;
}

class Course {
 public:
  Course(canopen::Duration timeout, OnTimeout on_timeout) : timeout_(timeout, on_timeout) {}

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
        return give(kPlc, ControlUse::run), true;
      case 'B':
        return give(kMqtt, ControlUse::run), true;
      case 'S':
        return give(kPlc, ControlUse::stop), true;
      case 'T':
        return give(kMqtt, ControlUse::stop), true;
      case 'm':
        return give(kPlc, ControlUse::momentary), true;
      case 'J':
        return timeout_.on_accepted(kPlc, ControlUse::run, now_), true;
      case 'K':
        return timeout_.on_accepted(kMqtt, ControlUse::run, now_), true;
      case 'L':
        return timeout_.on_confirmed(kMqtt, ControlUse::run, now_), true;
      case 'p':
        return timeout_.on_accepted(kPlc, ControlUse::none, now_), true;
      case 'q':
        return timeout_.on_accepted(kMqtt, ControlUse::none, now_), true;
      case 'a':
        return timeout_.on_sign_of_life(kPlc, now_), true;
      case 'b':
        return timeout_.on_sign_of_life(kMqtt, now_), true;
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
        timeout_.on_confirmed(kLocal, ControlUse::stop, now_);
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
  Course course(3s, GetParam().on_timeout);
  EXPECT_EQ(course.run(GetParam().course), GetParam().result);
}

constexpr auto kHold = OnTimeout::hold;
constexpr auto kCease = OnTimeout::cease;
constexpr auto kValues = OnTimeout::values;

INSTANTIATE_TEST_SUITE_P(
    WhoseSilence, TimeoutCases,
    testing::Values(TimeoutCase{"NobodyCommanded", kHold, "ab......", "........"},
                    TimeoutCase{"Silent", kHold, "A......", "...!!!!"},
                    TimeoutCase{"OwnSignsOfLife", kHold, "A.a..a..p....", "...........!!"},
                    TimeoutCase{"SignsOfOthersDoNotHelp", kHold, "A.b.q.b", "...!!!!"},
                    TimeoutCase{"TheLastConfirmedWriterCounts", kHold, "A.B.a.a", ".....!!"},
                    TimeoutCase{"NotOneWhoseCommandIsNotConfirmed", kHold, "A.K.b.b", "...!!!!"},
                    TimeoutCase{"FromTheAcceptanceNotTheConfirmation", kHold, "K.L....", "...!!!!"},
                    TimeoutCase{"SignsBeforeTheConfirmationCount", kHold, "K.bL....", ".....!!!"},
                    TimeoutCase{"ConfirmedWhenItsWriterWasSilentTooLong", kHold, "K...A.L", "......!"},
                    TimeoutCase{"StopIsNotWatched", kHold, "A.S.....", "........"},
                    TimeoutCase{"StopOfAnotherIsNotWatched", kHold, "A.T.....", "........"},
                    TimeoutCase{"AStandstillIsNoStop", kHold, "A10....", "...!!!!"},
                    TimeoutCase{"FaultResetIsNoStop", kHold, "m....", "...!!"},
                    TimeoutCase{"SetPointsAloneAreNotWatched", kHold, "p.....", "......"},
                    TimeoutCase{"SessionEnds", kHold, "A.e.....", "........"}),
    name_of_case);

INSTANTIATE_TEST_SUITE_P(Takeover, TimeoutCases,
                         testing::Values(TimeoutCase{"Running", kHold, "r.....", "...!!!"},
                                         TimeoutCase{"AnyWriterLives", kHold, "r.a.b.q....", ".........!!"},
                                         TimeoutCase{"KnownToRunLater", kHold, "u.1...", "...!!!"},
                                         TimeoutCase{"FoundStanding", kHold, "u.0..1..", "........"},
                                         TimeoutCase{"NobodyKnows", kHold, "u.......", "........"},
                                         TimeoutCase{"ComesToAStop", kHold, "r.0.....", "........"},
                                         TimeoutCase{"AWriterTakesCharge", kHold, "r.A.b.b", ".....!!"},
                                         TimeoutCase{"LostAgain", kHold, "r.e.....", "........"},
                                         TimeoutCase{"AWriterTookChargeBeforeItWasKnownToRun", kHold, "u.A1b...",
                                                     ".....!!!"},
                                         TimeoutCase{"LostBeforeItWasKnownToRun", kHold, "ue1.....", "........"},
                                         TimeoutCase{"BackBeforeItActed", kHold, "A.er....", "......!!"},
                                         TimeoutCase{"BackAfterItActed", kCease, "A...er.......", "...C!!!!!!!!!"}),
                         name_of_case);

INSTANTIATE_TEST_SUITE_P(
    End, TimeoutCases,
    testing::Values(TimeoutCase{"SignsOfLifeEndNothing", kHold, "A...ab.a", "...!!!!!"},
                    TimeoutCase{"SetPointsEndNothing", kHold, "A...p.q.", "...!!!!!"},
                    TimeoutCase{"NorDoesTheEndOfTheSession", kHold, "A...e...", "...!!!!!"},
                    TimeoutCase{"AcceptedCommandEndsIt", kHold, "A....B..b", "...!!...."},
                    TimeoutCase{"StopEndsIt", kHold, "A....T......", "...!!......."},
                    TimeoutCase{"WhoEndedItIsWatchedThoughHisCommandFailed", kHold, "A....K.a..b", "...!!...!!!"},
                    TimeoutCase{"NobodyIsWatchedWhereTheDriveHoldsAStop", kValues, "A...sK......", "...W!......."},
                    TimeoutCase{"NorWhereItWasTakenOverAndStopped", kCease, "A...er0K....", "...C!!!....."},
                    TimeoutCase{"ButWhereItStillRuns", kCease, "A...er.K....", "...C!!!...C!"},
                    TimeoutCase{"EarlierCommandConfirmedLate", kCease, "A.K.L...", "...C!C!!"}),
    name_of_case);

INSTANTIATE_TEST_SUITE_P(
    Actions, TimeoutCases,
    testing::Values(TimeoutCase{"HoldShowsOnly", kHold, "A.....", "...!!!"},
                    TimeoutCase{"CeaseOnce", kCease, "A.....", "...C!!"},
                    TimeoutCase{"CeaseAgainForTheNext", kCease, "A....B....", "...C!...C!"},
                    TimeoutCase{"ValuesOnceWhereConfirmed", kValues, "A...+...", "...W!!!!"},
                    TimeoutCase{"ValuesEachSecondWhereNot", kValues, "A...---+...", "...WWWW!!!!"},
                    TimeoutCase{"NotWhileTheLastIsNotAnswered", kValues, "A.....-.+..", "...W!!W!!!!"},
                    TimeoutCase{"UntilACommandIsAccepted", kValues, "A...-B.b.b", "...WW....."},
                    TimeoutCase{"ThoughTheLastAttemptIsAnsweredLater", kValues, "A...-J-a.a", "...WW....."},
                    TimeoutCase{"NotUntilASetPointIsAccepted", kValues, "A...-p-+", "...WW!W!"},
                    TimeoutCase{"GivenUpWithTheSession", kValues, "A...-e-...", "...WW!!!!!"},
                    TimeoutCase{"NoValuesForADriveThatComesBack", kValues, "A...-e-r.1....", "...WW!!!!!!!!!"},
                    TimeoutCase{"LateFailureIsNotOfTheNextTime", kValues, "A....B....-+.", "...W!...!!W!!"},
                    TimeoutCase{"NorIsALateConfirmation", kValues, "A....B....+.-+.", "...W!...!!W!W!!"}),
    name_of_case);

TEST(CommandTimeout, WithoutTimeNothingIsWatched) {
  Course course(0s, OnTimeout::values);
  EXPECT_EQ(course.run("A.....r.u1...e"), "..............");
  EXPECT_EQ(course.timeout().next_time(), canopen::kNever);
}

TEST(CommandTimeout, NextTimeIsTheEndOfTheSilenceThenTheNextAttempt) {
  Course course(2500ms, OnTimeout::values);
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
  Course course(2s, OnTimeout::cease);
  const auto start = course.now();
  course.run("A");
  EXPECT_EQ(course.timeout().expire(start + 5s), CommandTimeout::Action::none);
  EXPECT_FALSE(course.timeout().acted());
  const auto again = course.timeout().next_time();
  EXPECT_GT(again, start + 5s);
  EXPECT_LE(again, start + 5100ms);

  Course lives = course;
  lives.timeout().on_sign_of_life(kPlc, start + 5s);
  EXPECT_EQ(lives.timeout().next_time(), start + 7s);
  EXPECT_EQ(lives.timeout().expire(again), CommandTimeout::Action::none);
  EXPECT_FALSE(lives.timeout().acted());

  EXPECT_EQ(course.timeout().expire(start + 9s), CommandTimeout::Action::cease) << "once only, however late";
}

std::string alarm_after(OnTimeout on_timeout, const std::string& course) {
  Course played(2s, on_timeout);
  played.run(course);
  const auto alarm = played.timeout().alarm();
  return alarm ? std::string(name_of(alarm->reason)) + ": " + alarm->text : "";
}

TEST(CommandTimeout, AlarmSaysWhoseSilenceAndWhatBecameOfIt) {
  EXPECT_EQ(alarm_after(kHold, "A."), "");
  EXPECT_EQ(alarm_after(kHold, "A.."), "timeout: no sign of life of modbus 192.0.2.7 for 2s: the drive goes on");
  EXPECT_EQ(alarm_after(kCease, "B.."), "timeout: no sign of life of mqtt for 2s: RPDOs are repeated no more");
  EXPECT_EQ(alarm_after(kHold, "r.."), "timeout: no sign of life of any writer for 2s: the drive goes on");
  const std::string silence = "no sign of life of modbus 192.0.2.7 for 2s: ";
  EXPECT_EQ(alarm_after(kValues, "A.."), "timeout: " + silence + "its values are being written");
  EXPECT_EQ(alarm_after(kValues, "A..+"), "timeout: " + silence + "its values were written");
  EXPECT_EQ(alarm_after(kValues, "A..-"),
            "timeout-failed: " + silence + "its values are not confirmed: refused by the drive");
  EXPECT_EQ(alarm_after(kValues, "A..-+"), "timeout: " + silence + "its values were written");
  const std::string given_up =
      "its values are not confirmed, and given up since the drive was lost or left operational";
  EXPECT_EQ(alarm_after(kValues, "A..e"), "timeout-failed: " + silence + given_up);
  EXPECT_EQ(alarm_after(kValues, "A..-e"), "timeout-failed: " + silence + given_up);
  EXPECT_EQ(alarm_after(kValues, "A..+e"), "timeout: " + silence + "its values were written");
  EXPECT_EQ(alarm_after(kValues, "A..-J"), "");
  EXPECT_EQ(alarm_after(kValues, "A..-J-.."), "timeout: " + silence + "its values are being written") << "the next";
}

}  // namespace
}  // namespace process
