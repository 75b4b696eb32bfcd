// NMT start, by command or at the end of a boot: whether it was begun, and what is said of it.

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/unit/canopen/node_life_bench.h"

namespace canopen {
namespace {

using namespace std::chrono_literals;

class StartCommandTest : public NodeLifeBench {};

TEST_F(StartCommandTest, LeftAloneItIsLookedAtAgainEachMinute) {
  running(bench_settings());
  slave_.set(kTpdoEventTimer, DataType::u16, 0);
  start(bench_settings());
  loop_.advance(1s);
  ASSERT_EQ(status().boot_result, BootResult::left_alone);
  slave_.set(kTpdoEventTimer, DataType::u16, 100);
  loop_.advance(58s, 10ms);
  EXPECT_FALSE(status().online);
  EXPECT_TRUE(wait_online(3s));
  expect_untouched();
}

TEST_F(StartCommandTest, LeftAloneItIsLookedAtAgainOnAStartCommand) {
  running(bench_settings());
  slave_.set(kTpdoEventTimer, DataType::u16, 0);
  start(bench_settings());
  loop_.advance(1s);
  const auto in_vain = command(NmtCommand::start);
  loop_.advance(800ms);
  ASSERT_TRUE(in_vain.done());
  EXPECT_EQ(in_vain.get().error().kind, ErrorKind::refused);
  EXPECT_NE(in_vain.get().error().detail.find("event timer"), std::string::npos) << in_vain.get().error().detail;
  slave_.set(kTpdoEventTimer, DataType::u16, 100);
  const auto started = command(NmtCommand::start);
  loop_.advance(800ms);
  ASSERT_TRUE(started.done());
  EXPECT_TRUE(started.get().has_value()) << to_string(started.get().error());
  EXPECT_TRUE(status().online);
  expect_untouched();
}

TEST_F(StartCommandTest, LeavingRightAfterOneInVainItIsHeld) {
  running(bench_settings());
  slave_.set(kTpdoEventTimer, DataType::u16, 0);
  start(bench_settings());
  loop_.advance(1100ms);
  ASSERT_EQ(status().boot_result, BootResult::left_alone) << status().boot_text;
  const auto in_vain = command(NmtCommand::start);
  loop_.advance(20ms);
  ASSERT_TRUE(in_vain.done());
  ASSERT_TRUE(in_vain.get().has_error());
  says(127);
  loop_.advance(20s, 10ms);
  expect_let_be();
}

// The boot ends in the start that was asked for, so nobody may be told that it will not take place.
TEST_F(StartCommandTest, DuringABootThatTakesLongerItsOutcomeIsUnknown) {
  install(bench_settings());
  slave_.delay_answers(50ms);
  start(bench_settings());
  slave_.boot_up();
  loop_.advance(100ms);
  const auto started = command(NmtCommand::start, 200ms);
  loop_.advance(201ms);
  ASSERT_TRUE(started.done());
  ASSERT_TRUE(started.get().has_error());
  EXPECT_TRUE(started.get().error().outcome_unknown) << to_string(started.get().error());
  loop_.advance(5s);
  EXPECT_EQ(nmt_heard(), std::vector<Frame>{nmt(1)});
}

TEST_F(StartCommandTest, TwoThatWereNotBegunStartNothing) {
  NodeSettings settings = bench_settings();
  settings.error_control.heartbeat = Duration::zero();
  settings.motor.running = kRunning;
  slave_.set(kStatusWord, DataType::u16, 0);
  bring_online(settings);
  says(127);
  loop_.advance(3s);  // What its state is now has to be learnt again.
  const auto first = command(NmtCommand::start, 300ms);
  loop_.advance(10ms);
  const auto second = command(NmtCommand::start, 300ms);
  loop_.advance(301ms);
  for (const Sent& sent : {first, second}) {
    ASSERT_TRUE(sent.done());
    ASSERT_TRUE(sent.get().has_error());
    EXPECT_FALSE(sent.get().error().outcome_unknown);
  }
  loop_.advance(30s, 10ms);
  EXPECT_TRUE(nmt_heard().empty());
}

TEST_F(StartCommandTest, ADriveThatGoesOperationalAfterTheAlarmEndsIt) {
  install(bench_settings());
  slave_.ignore_nmt(true);
  start(bench_settings());
  slave_.boot_up();
  ASSERT_TRUE(wait_nmt());
  loop_.advance(1600ms);
  ASSERT_TRUE(told("NMT start was sent, but the drive stays")) << status().boot_text;
  says(5);
  loop_.advance(1s);
  EXPECT_TRUE(status().online);
  EXPECT_EQ(status().boot_result, BootResult::ok) << status().boot_text;
  EXPECT_EQ(starts(), 1);
}

TEST_F(StartCommandTest, ADriveThatRefusesToStartSaysWhy) {
  install(bench_settings());
  slave_.set({0x1001, 0}, DataType::u8, 0x21);
  slave_.set({0x1003, 1}, DataType::u32, 0x00002310);
  slave_.ignore_nmt(true);
  start(bench_settings());
  slave_.boot_up();
  loop_.advance(2500ms);
  EXPECT_EQ(status().boot_result, BootResult::not_configured);
  EXPECT_NE(status().boot_text.find("error register 0x1001 is 0x21 (generic error, device profile); its newest errors: "
                                    "0x1003:01 is 0x00002310"),
            std::string::npos)
      << status().boot_text;
}

}  // namespace
}  // namespace canopen
