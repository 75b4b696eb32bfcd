// A node that left operational by itself: neither configured nor started again before an NMT start command or its
// boot-up, whatever it was being looked at for when it left.

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/unit/canopen/node_bench.h"

namespace canopen {
namespace {

using namespace std::chrono_literals;

class HeldNodeTest : public NodeCommandBench {
 protected:
  /// Found operational with a difference, and left alone for it.
  void leave_alone(const NodeSettings& settings) {
    install(settings);
    slave_.set({0x1800, 5}, DataType::u16, 0);
    slave_.set_state(5);
    start(settings);
    loop_.advance(1s);
    ASSERT_EQ(status().boot_result, BootResult::left_alone) << status().boot_text;
  }
  void expect_held() {
    EXPECT_EQ(status().boot_result, BootResult::not_configured);
    EXPECT_EQ(status().held_back, HeldBack::left_operational);
    EXPECT_NE(status().boot_text.find("left operational by itself"), std::string::npos) << status().boot_text;
    EXPECT_EQ(status().nmt, NmtState::pre_operational);
    EXPECT_TRUE(slave_.writes().empty());
    EXPECT_TRUE(nmt_heard().empty());
  }
  void expect_readable() {
    const auto reading = support::spawn(loop_.executor(), node_->read(kControlWord, DataType::u16));
    loop_.advance(5ms);
    ASSERT_TRUE(reading.done());
    EXPECT_TRUE(reading.get().has_value()) << to_string(reading.get().error());
  }
};

TEST_F(HeldNodeTest, LeavingWhileItIsLeftAloneIsNotCorrected) {
  leave_alone(bench_settings());
  slave_.set_state(127);
  loop_.advance(600ms);
  expect_held();
  EXPECT_FALSE(status().online);
  loop_.advance(60s, 10ms);
  expect_held();
  EXPECT_FALSE(status().lost);
  expect_readable();
}

TEST_F(HeldNodeTest, LeavingWhileItIsInspectedIsNotCorrected) {
  install(bench_settings());
  slave_.set_state(5);
  slave_.delay_answers(20ms);
  start(bench_settings());
  loop_.advance(50ms);
  ASSERT_GT(slave_.reads().size(), 1U);
  slave_.set_state(127);
  slave_.send(0x705, {127});
  loop_.advance(30s, 10ms);
  expect_held();
  EXPECT_TRUE(events_.arrivals.empty());
}

TEST_F(HeldNodeTest, LeavingWhileItIsBootedEndsTheBoot) {
  install(bench_settings());
  slave_.delay_answers(20ms);
  slave_.set({0x1A00, 2}, DataType::u32, 0);
  start(bench_settings());
  slave_.boot_up();
  loop_.advance(50ms);
  slave_.set_state(5);  // Somebody else starts it, and it does not last.
  slave_.send(0x705, {5});
  loop_.advance(1ms);
  slave_.set_state(127);
  slave_.send(0x705, {127});
  loop_.advance(1ms);
  slave_.forget_heard();
  loop_.advance(30s, 10ms);
  expect_held();
}

TEST_F(HeldNodeTest, BootUpEndsIt) {
  leave_alone(bench_settings());
  slave_.set_state(127);
  loop_.advance(10s, 10ms);
  expect_held();
  slave_.boot_up();
  ASSERT_TRUE(wait_online());
  EXPECT_EQ(slave_.value({0x1800, 5}), 100U);
  EXPECT_EQ(nmt_heard(), std::vector<Frame>{nmt(1)});
  EXPECT_EQ(status().boot_result, BootResult::ok);
}

TEST_F(HeldNodeTest, StartCommandEndsItWithAFullBoot) {
  leave_alone(bench_settings());
  slave_.set_state(127);
  loop_.advance(10s, 10ms);
  const auto started = command(NmtCommand::start);
  ASSERT_TRUE(loop_.advance_until([&] { return started.done(); }, 1s));
  EXPECT_TRUE(started.get().has_value());
  ASSERT_TRUE(wait_online());
  EXPECT_EQ(slave_.value({0x1800, 5}), 100U);
  EXPECT_EQ(nmt_heard(), std::vector<Frame>{nmt(1)});
}

TEST_F(HeldNodeTest, StartedBySomebodyElseItIsInspectedAgain) {
  leave_alone(bench_settings());
  slave_.set_state(127);
  loop_.advance(10s, 10ms);
  slave_.set({0x1800, 5}, DataType::u16, 100);
  slave_.set_state(5);
  ASSERT_TRUE(wait_online());
  EXPECT_EQ(events_.arrivals, std::vector<Arrival>{Arrival::taken_over});
  EXPECT_TRUE(slave_.writes().empty());
  EXPECT_TRUE(nmt_heard().empty());
}

TEST_F(HeldNodeTest, PreOperationalByCommandIsNoSurpriseWhileItIsLeftAlone) {
  leave_alone(bench_settings());
  const auto sent = command(NmtCommand::pre_operational);
  loop_.advance(5s);
  ASSERT_TRUE(sent.done() && sent.get().has_value());
  EXPECT_EQ(status().boot_result, BootResult::ok) << status().boot_text;
  EXPECT_EQ(status().nmt, NmtState::pre_operational);
  EXPECT_EQ(nmt_heard(), std::vector<Frame>{nmt(128)});
}

TEST_F(HeldNodeTest, AStopIsNotForgottenWhereATakeoverComesBeforeTheHeartbeatThatTells) {
  NodeSettings settings = bench_settings();
  install(settings);
  settings.identity.vendor = 0x91;  // Looked at again every five seconds.
  slave_.set_state(5);
  start(settings);
  loop_.advance(20ms);
  ASSERT_EQ(status().boot_result, BootResult::other_vendor);
  loop_.advance(4970ms);
  const auto sent = command(NmtCommand::pre_operational);
  slave_.set({0x1018, 1}, DataType::u32, 0x91);
  loop_.advance(20s, 10ms);
  ASSERT_TRUE(sent.done() && sent.get().has_value());
  EXPECT_EQ(status().nmt, NmtState::pre_operational);
  EXPECT_EQ(nmt_heard(), std::vector<Frame>{nmt(128)});
}

TEST_F(HeldNodeTest, PreOperationalByReconfigurationIsNoSurprise) {
  NodeSettings settings = bench_settings();
  settings.reconfigure_running = true;
  install(settings);
  slave_.set({0x1800, 5}, DataType::u16, 0);
  slave_.ignore_write({0x1800, 5});
  slave_.set_state(5);
  start(settings);
  loop_.advance(20ms);
  ASSERT_EQ(nmt_heard(), std::vector<Frame>{nmt(128)});
  slave_.send(0x705, {5});  // From before the command.
  loop_.advance(1500ms);
  EXPECT_NE(status().boot_text.find("after it was written"), std::string::npos) << status().boot_text;
  slave_.set({0x1800, 5}, DataType::u16, 100);
  ASSERT_TRUE(wait_online(6s));
  EXPECT_EQ(nmt_heard(), (std::vector<Frame>{nmt(128), nmt(1)}));
}

TEST_F(HeldNodeTest, StartWhoseBootTakesLongerIsOfUnknownOutcome) {
  bring_online(bench_settings());
  slave_.set_state(127);
  loop_.advance(1s);
  slave_.delay_answers(100ms);
  const auto started = command(NmtCommand::start, 300ms);
  loop_.advance(301ms);
  ASSERT_TRUE(started.done());
  EXPECT_EQ(started.get().error().kind, ErrorKind::timeout);
  EXPECT_TRUE(started.get().error().outcome_unknown) << "the boot that it began goes on";
  ASSERT_TRUE(wait_online(5s));
  EXPECT_EQ(nmt_heard(), std::vector<Frame>{nmt(1)});
}

TEST_F(HeldNodeTest, StartWhoseBootHasNotBegunIsWithdrawn) {
  NodeSettings settings = bench_settings();
  settings.error_control.heartbeat = Duration::zero();
  settings.motor.running = kRunning;
  slave_.set(kRunning.object, DataType::u16, 0);
  bring_online(settings);
  slave_.set_state(127);
  slave_.send(0x705, {127});
  loop_.advance(3s);  // What its state is now has to be learnt again.
  expect_held();
  const auto started = command(NmtCommand::start, 300ms);
  loop_.advance(301ms);
  ASSERT_TRUE(started.done());
  EXPECT_EQ(started.get().error().kind, ErrorKind::timeout);
  EXPECT_FALSE(started.get().error().outcome_unknown);
  loop_.advance(30s, 10ms);
  expect_held();
  const auto again = command(NmtCommand::start, 5s);
  loop_.advance(5s);
  ASSERT_TRUE(again.done());
  EXPECT_TRUE(again.get().has_value());
  EXPECT_EQ(nmt_heard(), std::vector<Frame>{nmt(1)});
}

}  // namespace
}  // namespace canopen
