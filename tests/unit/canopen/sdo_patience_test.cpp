// A drive whose SDO server wakes up some time after its boot-up (`sdo.patience`): no letter before that time is over.

#include "canopen/node/sdo_patience.h"

#include <gtest/gtest.h>

#include <string>

#include "tests/unit/canopen/node_life_bench.h"

namespace canopen {
namespace {

using namespace std::chrono_literals;

const TimePoint kBegin{1h};

TEST(SdoPatience, CountsFromTheBootUp) {
  SdoPatience patience(5s);
  EXPECT_FALSE(patience.lasts(kBegin));
  patience.begin(kBegin);
  EXPECT_TRUE(patience.lasts(kBegin + 4999ms));
  EXPECT_FALSE(patience.lasts(kBegin + 5s));
}

TEST(SdoPatience, WithoutATimeThereIsNone) {
  SdoPatience patience({});
  patience.begin(kBegin);
  EXPECT_FALSE(patience.lasts(kBegin));
}

TEST(SdoPatience, OfADriveThatWasAwayItCountsFromItsFirstSign) {
  SdoPatience patience(5s);
  patience.hear(false, kBegin);
  EXPECT_EQ(patience.until(), kBegin + 5s);
  patience.hear(false, kBegin + 1s);
  EXPECT_EQ(patience.until(), kBegin + 5s) << "once";
  patience.expect_boot_up();
  patience.hear(false, kBegin + 60s);
  EXPECT_EQ(patience.until(), kBegin + 65s);
}

TEST(SdoPatience, OneThatIsOperationalHasLongBooted) {
  SdoPatience patience(5s);
  patience.hear(true, kBegin);
  EXPECT_FALSE(patience.lasts(kBegin));
  patience.hear(false, kBegin + 1s);
  EXPECT_FALSE(patience.lasts(kBegin + 1s)) << "it left operational";
}

TEST(SdoPatience, PausesGrowAndNoneGoesPastItsEnd) {
  SdoPatience patience(5s);
  patience.begin(kBegin);
  EXPECT_EQ(patience.next_try(kBegin), kBegin + 500ms);
  EXPECT_EQ(patience.next_try(kBegin), kBegin + 1s);
  EXPECT_EQ(patience.next_try(kBegin), kBegin + 2s);
  EXPECT_EQ(patience.next_try(kBegin), kBegin + 2s);
  EXPECT_EQ(patience.next_try(kBegin + 4s), kBegin + 5s);
  patience.settle();
  patience.begin(kBegin + 9s);
  EXPECT_EQ(patience.next_try(kBegin + 9s), kBegin + 9500ms);
}

TEST(SdoPatience, ABootUpBeforeABootHasEndedDoesNotProlongIt) {
  SdoPatience patience(5s);
  for (const Duration at : {0s, 4s, 8s}) {
    patience.begin(kBegin + at);
    EXPECT_EQ(patience.until(), kBegin + 5s);
  }
  EXPECT_FALSE(patience.lasts(kBegin + 8s));
}

TEST(SdoPatience, OneBehindALossOrAResetOfOursBeginsAnew) {
  SdoPatience patience(5s);
  patience.begin(kBegin);
  patience.expect_boot_up();
  patience.begin(kBegin + 4s);
  EXPECT_EQ(patience.until(), kBegin + 9s);
}

TEST(SdoPatience, OneBehindABootThatHasEndedBeginsAnew) {
  SdoPatience patience(5s);
  patience.begin(kBegin);
  patience.settle();
  patience.begin(kBegin + 4s);
  EXPECT_EQ(patience.until(), kBegin + 9s);
  SdoPatience of_a_running_one(5s);
  of_a_running_one.hear(true, kBegin);
  of_a_running_one.begin(kBegin + 4s);
  EXPECT_EQ(of_a_running_one.until(), kBegin + 9s);
}

class LateServerTest : public NodeLifeBench {
 protected:
  static NodeSettings patient(Duration patience) {
    NodeSettings settings = with_motor();
    settings.sdo.patience = patience;
    return settings;
  }
  void boots_with_a_silent_server(const NodeSettings& settings) {
    install(settings);
    motor_stands();
    slave_.mute_sdo(true);
    start(settings);
    slave_.boot_up();
    loop_.settle();
  }
  /// No letter, no loss, nothing wrong was told so far.
  void expect_no_alarm() {
    for (const NodeStatus& status : events_.statuses) {
      EXPECT_FALSE(is_letter(status.boot_result)) << status.boot_text;
      EXPECT_EQ(status.boot_text, "");
      EXPECT_FALSE(status.lost);
    }
  }
};

TEST_F(LateServerTest, OneThatWakesUpInTimeComesOnlineWithoutAnAlarm) {
  boots_with_a_silent_server(patient(6s));
  loop_.advance(4s);
  EXPECT_TRUE(node_->arriving()) << "its boot is under way";
  EXPECT_LE(slave_.reads().size(), 6U) << "with pauses";
  EXPECT_EQ(status().boot_result, BootResult::not_booted);
  slave_.mute_sdo(false);
  ASSERT_TRUE(wait_online(3s)) << status().boot_text;
  expect_no_alarm();
  ASSERT_EQ(events_.remarks.size(), 1U);
  EXPECT_NE(events_.remarks.front().find("sdo.patience"), std::string::npos) << events_.remarks.front();
  EXPECT_EQ(nmt_heard(), std::vector<Frame>{nmt(1)});
}

TEST_F(LateServerTest, OneThatNeverWakesUpHasItsLetterAfterThatTime) {
  boots_with_a_silent_server(patient(6s));
  loop_.advance(6s);
  expect_no_alarm();
  ASSERT_TRUE(loop_.advance_until([this] { return is_letter(status().boot_result); }, 5s));
  EXPECT_EQ(status().boot_result, BootResult::no_answer) << status().boot_text;
  EXPECT_EQ(nmt_heard(), std::vector<Frame>{});
}

TEST_F(LateServerTest, WithoutPatienceTheLetterComesWithTheFirstTry) {
  boots_with_a_silent_server(patient({}));
  ASSERT_TRUE(loop_.advance_until([this] { return is_letter(status().boot_result); }, 4s));
  EXPECT_EQ(status().boot_result, BootResult::no_answer);
}

TEST_F(LateServerTest, OneThatFallsSilentAgainIsWaitedForToo) {
  install(patient(8s));
  motor_stands();
  int answers = 0;
  slave_.script([&answers](const Bytes&) { return ++answers > 3 ? Answers(std::vector<Bytes>{}) : std::nullopt; });
  start(patient(8s));
  slave_.boot_up();
  loop_.advance(7900ms);
  expect_no_alarm();
  slave_.script({});
  ASSERT_TRUE(wait_online(5s)) << status().boot_text;
  expect_no_alarm();
}

TEST_F(LateServerTest, OneThatRebootsForEverHasItsLetter) {
  boots_with_a_silent_server(patient(6s));
  int letters = 0;
  for (int reboot = 0; reboot < 5; ++reboot) {
    loop_.advance(4s);
    letters += is_letter(status().boot_result) ? 1 : 0;
    slave_.boot_up();
    loop_.settle();
  }
  EXPECT_EQ(letters, 4) << "all but the first time";
  EXPECT_EQ(status().boot_ups, 6U);
}

TEST_F(LateServerTest, OneThatWasInServiceMaySleepAgainBehindItsNextBootUp) {
  boots_with_a_silent_server(patient(6s));
  loop_.advance(3s);
  slave_.mute_sdo(false);
  ASSERT_TRUE(wait_online(5s)) << status().boot_text;
  loop_.advance(10s);
  slave_.mute_sdo(true);
  slave_.boot_up();
  loop_.advance(5900ms);
  expect_no_alarm();
}

TEST_F(LateServerTest, OneWhoseBootUpNobodyHeardIsWaitedForFromItsFirstHeartbeat) {
  install(patient(6s));
  motor_stands();
  slave_.mute_sdo(true);
  start(patient(6s));
  loop_.advance(5900ms);
  expect_no_alarm();
  slave_.mute_sdo(false);
  ASSERT_TRUE(wait_online(5s)) << status().boot_text;
}

TEST_F(LateServerTest, OneThatRunsIsNot) {
  running(patient(60s));
  slave_.mute_sdo(true);
  start(patient(60s));
  ASSERT_TRUE(loop_.advance_until([this] { return is_letter(status().boot_result); }, 6s));
  EXPECT_EQ(status().boot_result, BootResult::no_answer) << "it is there for long";
}

TEST_F(LateServerTest, OneThatDiesMeanwhileIsLostAfterItsTimeout) {
  boots_with_a_silent_server(patient(60s));
  loop_.advance(2s);
  slave_.unplug(true);
  loop_.advance(900ms);
  expect_no_alarm();
  loop_.advance(700ms);  // Heartbeats came each 500 ms.
  EXPECT_TRUE(status().lost);
  EXPECT_EQ(status().heartbeat_losses, 1U);
  loop_.advance(60s, 5ms);
  EXPECT_TRUE(status().lost) << "for good";
  slave_.unplug(false);
  slave_.mute_sdo(false);
  slave_.boot_up();
  EXPECT_TRUE(wait_online(5s)) << status().boot_text;
}

// What it will be told comes later; as it boots its heartbeat is that of the factory.
TEST_F(LateServerTest, AHeartbeatSlowerThanTheTimeoutIsWatchedByItsOwnPeriod) {
  install(patient(60s));
  motor_stands();
  slave_.set(kHeartbeatTime, DataType::u16, 2000);
  slave_.mute_sdo(true);
  start(patient(60s));
  slave_.boot_up();
  loop_.advance(20s);
  expect_no_alarm();
  slave_.unplug(true);
  loop_.advance(3100ms);
  EXPECT_TRUE(status().lost);
}

TEST_F(LateServerTest, OneWithoutAHeartbeatIsNotMissedMeanwhile) {
  install(patient(20s));
  motor_stands();
  slave_.set(kHeartbeatTime, DataType::u16, 0);
  slave_.mute_sdo(true);
  start(patient(20s));
  slave_.boot_up();
  loop_.advance(19s);
  expect_no_alarm();
  slave_.mute_sdo(false);
  EXPECT_TRUE(wait_online(5s)) << status().boot_text;
}

TEST_F(LateServerTest, AnNmtStartTriesAtOnce) {
  boots_with_a_silent_server(patient(60s));
  loop_.advance(10s);
  std::size_t before = 0;
  while (slave_.reads().size() != before) {
    before = slave_.reads().size();
    loop_.advance(700ms);  // Longer than between two requests of a try: a pause of 2 s has begun.
  }
  slave_.mute_sdo(false);
  const auto started = command(NmtCommand::start, 3s);
  EXPECT_TRUE(loop_.advance_until([&] { return slave_.reads().size() > before; }, 700ms));
  loop_.advance(2s);
  ASSERT_TRUE(started.done());
  EXPECT_TRUE(started.get().has_value()) << to_string(started.get().error());
}

TEST_F(LateServerTest, CommandsAreRefusedMeanwhileAndAStopIsSent) {
  boots_with_a_silent_server(patient(10s));
  loop_.advance(2s);
  expect_write_refused();
  slave_.forget_heard();
  const auto stop =
      support::spawn(loop_.executor(), node_->write_stop(kControlWord, DataType::u16, 6, Clock::now() + kDeadline));
  loop_.advance(kDeadline + 10ms);
  ASSERT_TRUE(stop.done());
  EXPECT_EQ(stop.get().error().kind, ErrorKind::offline);
  EXPECT_TRUE(stop.get().error().outcome_unknown) << "sent, not confirmed";
  EXPECT_EQ(slave_.writes(), std::vector<ObjectAddress>{kControlWord});
  slave_.mute_sdo(false);
  ASSERT_TRUE(wait_online(5s)) << "the boot goes on behind it";
  expect_no_alarm();
}

}  // namespace
}  // namespace canopen
