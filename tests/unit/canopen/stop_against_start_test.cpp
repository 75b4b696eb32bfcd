// A stop, or pre-operational, by command against the NMT start that a boot ends in: whichever of the two is under way
// when the other is given, the node is not started behind a stop, and what the stop brings about is no alarm.

#include <gtest/gtest.h>

#include <array>
#include <memory>
#include <span>
#include <vector>

#include "tests/unit/canopen/node_life_bench.h"

namespace canopen {
namespace {

using namespace std::chrono_literals;

class StopAgainstStartTest : public NodeLifeBench {
 protected:
  /// What a stop by command brings about is no alarm, for no moment.
  void expect_no_letter_told() {
    for (const NodeStatus& told : events_.statuses) {
      EXPECT_FALSE(is_letter(told.boot_result)) << told.boot_text;
    }
  }
};

TEST_F(StopAgainstStartTest, AStopThatFollowsTheStartBeforeItShowsIsKept) {
  install(bench_settings());
  start(bench_settings());
  slave_.boot_up();
  ASSERT_TRUE(wait_nmt());
  loop_.advance(1ms);
  ASSERT_FALSE(status().online);
  ASSERT_TRUE(command_now(NmtCommand::pre_operational).has_value());
  loop_.advance(30s, 10ms);
  EXPECT_EQ(nmt_heard(), (std::vector<Frame>{nmt(1), nmt(128)}));
}

TEST_F(StopAgainstStartTest, AStopWithdrawsTheStartThatWaits) {
  hold_its_start(bench_settings());
  const auto sent = command(NmtCommand::pre_operational);
  loop_.advance(100ms);
  closed_ = false;
  loop_.advance(30s, 10ms);
  ASSERT_TRUE(sent.done() && sent.get().has_value());
  EXPECT_EQ(nmt_heard(), std::vector<Frame>{nmt(128)});
}

TEST_F(StopAgainstStartTest, AStopThatWaitsWhileTheBootEndsHoldsTheStartBack) {
  install(bench_settings());
  slave_.delay_answers(20ms);
  when_read(kLastRead, [this] { closed_ = true; });
  start(bench_settings());
  slave_.boot_up();
  ASSERT_TRUE(loop_.advance_until([this] { return closed_; }, 2s));
  const auto sent = command(NmtCommand::pre_operational);
  loop_.advance(50ms);
  ASSERT_TRUE(status().configured);
  closed_ = false;
  loop_.advance(30s, 10ms);
  ASSERT_TRUE(sent.done() && sent.get().has_value());
  EXPECT_EQ(nmt_heard(), std::vector<Frame>{nmt(128)});
}

TEST_F(StopAgainstStartTest, AStartThatWaitsDoesNotFollowOneThatSomebodyElseUndid) {
  hold_its_start(bench_settings());
  says(5);
  says(127);
  closed_ = false;
  loop_.advance(10s, 10ms);
  EXPECT_TRUE(nmt_heard().empty());
}

TEST_F(StopAgainstStartTest, PreOperationalWhileItIsConfiguredLeavesItConfiguredAndNotStarted) {
  install(bench_settings());
  slave_.delay_answers(20ms);
  start(bench_settings());
  slave_.boot_up();
  loop_.advance(100ms);
  ASSERT_FALSE(status().configured);
  ASSERT_TRUE(command_now(NmtCommand::pre_operational).has_value());
  loop_.advance(10s);
  EXPECT_TRUE(status().configured);
  EXPECT_EQ(nmt_heard(), std::vector<Frame>{nmt(128)});
  EXPECT_EQ(status().boot_result, BootResult::ok) << status().boot_text;
}

TEST_F(StopAgainstStartTest, AStopThatCouldNotLeaveHoldsNoStartBack) {
  install(bench_settings());
  slave_.delay_answers(20ms);
  start(bench_settings());
  slave_.boot_up();
  loop_.advance(100ms);
  closed_ = true;
  const auto sent = command(NmtCommand::pre_operational, 50ms);
  loop_.advance(60ms);
  closed_ = false;
  ASSERT_TRUE(sent.done());
  ASSERT_TRUE(sent.get().has_error());
  ASSERT_TRUE(wait_online(5s)) << status().boot_text;
  EXPECT_EQ(nmt_heard(), std::vector<Frame>{nmt(1)});
}

TEST_F(StopAgainstStartTest, AStopWhileTheBootOfAStartCommandIsUnderWayIsKept) {
  bring_online(bench_settings());
  leave_operational();
  loop_.advance(1s);
  slave_.delay_answers(20ms);
  const auto started = command(NmtCommand::start, 5s);
  loop_.advance(100ms);
  ASSERT_FALSE(status().configured);
  ASSERT_TRUE(command_now(NmtCommand::pre_operational).has_value());
  loop_.advance(30s, 10ms);
  ASSERT_TRUE(started.done());
  EXPECT_TRUE(started.get().has_error());
  EXPECT_EQ(nmt_heard(), std::vector<Frame>{nmt(128)});
}

TEST_F(StopAgainstStartTest, StoppedWhileItIsConfiguredAfterItsBootUpItCanBeStartedAgain) {
  install(bench_settings());
  silent_when_stopped();
  slave_.delay_answers(20ms);
  start(bench_settings());
  slave_.boot_up();
  loop_.advance(50ms);
  ASSERT_TRUE(command_now(NmtCommand::stop).has_value());
  loop_.advance(20s, 10ms);
  expect_no_letter_told();
  const auto started = command(NmtCommand::start, 5s);
  loop_.advance(5s, 10ms);
  ASSERT_TRUE(started.done());
  EXPECT_TRUE(started.get().has_value()) << to_string(started.get().error());
  EXPECT_TRUE(status().online);
}

TEST_F(StopAgainstStartTest, StoppedWhileItIsConfiguredAsItWasFoundIsNoFailure) {
  install(bench_settings());
  silent_when_stopped();
  slave_.delay_answers(20ms);
  start(bench_settings());
  loop_.advance(50ms);
  ASSERT_TRUE(command_now(NmtCommand::stop).has_value());
  loop_.advance(30s, 10ms);
  expect_no_letter_told();
  EXPECT_EQ(nmt_heard(), std::vector<Frame>{nmt(2)});
}

TEST_F(StopAgainstStartTest, StoppedWhileItIsLeftAloneIsNoFailure) {
  running(bench_settings());
  silent_when_stopped();
  slave_.set(kTpdoEventTimer, DataType::u16, 0);
  start(bench_settings());
  loop_.advance(1s);
  ASSERT_EQ(status().boot_result, BootResult::left_alone) << status().boot_text;
  ASSERT_TRUE(command_now(NmtCommand::stop).has_value());
  loop_.advance(20s, 10ms);
  EXPECT_FALSE(is_letter(status().boot_result)) << status().boot_text;
  EXPECT_EQ(status().nmt, NmtState::stopped);
  EXPECT_EQ(nmt_heard(), std::vector<Frame>{nmt(2)});
}

/// Online by its first TPDO, before its first heartbeat; `restart` would start it again if it left by itself.
class CrossingHeartbeatTest : public NodeLifeBench {
 protected:
  void come_online_by_tpdo() {
    NodeSettings settings = with_motor();
    settings.restart = true;
    install(settings);
    start(settings);
    slave_.boot_up();
    ASSERT_TRUE(wait_nmt());
    send_tpdo(0x27, 1);
    ASSERT_TRUE(status().online);
    motor_stands();
  }
  void expect_stopped_by_command() {
    EXPECT_EQ(status().boot_result, BootResult::ok) << status().boot_text;
    EXPECT_EQ(nmt_heard(), (std::vector<Frame>{nmt(1), nmt(128)})) << "started again after it was stopped by command";
  }
};

TEST_F(CrossingHeartbeatTest, TheFirstSignSinceTheStartAfterTheStopHasLeft) {
  install(with_motor());
  start(with_motor());
  slave_.boot_up();
  ASSERT_TRUE(wait_nmt());
  ASSERT_TRUE(command_now(NmtCommand::pre_operational).has_value());
  slave_.send(0x705, {5});
  loop_.advance(60s, 10ms);
  expect_stopped_by_command();
}

TEST_F(CrossingHeartbeatTest, TheFirstOneSinceTheStartWhileTheStopWaits) {
  come_online_by_tpdo();
  closed_ = true;
  const auto sent = command(NmtCommand::pre_operational);
  loop_.advance(5ms);
  slave_.send(0x705, {5});
  loop_.advance(5ms);
  closed_ = false;
  loop_.advance(60s, 10ms);
  ASSERT_TRUE(sent.done() && sent.get().has_value());
  expect_stopped_by_command();
}

TEST_F(CrossingHeartbeatTest, TheFirstOneSinceTheStartAfterTheStopHasLeft) {
  come_online_by_tpdo();
  ASSERT_TRUE(command_now(NmtCommand::pre_operational).has_value());
  slave_.send(0x705, {5});
  loop_.advance(60s, 10ms);
  expect_stopped_by_command();
}

// Reconfiguring a running drive begins with pre-operational by us, which must not hide that somebody wanted it so.
TEST_F(StopAgainstStartTest, AStopIsNotForgottenByAReconfiguration) {
  NodeSettings settings = bench_settings();
  install(settings);
  settings.reconfigure_running = true;
  settings.identity.vendor = 0x91;  // Looked at again every five seconds.
  slave_.set(kTpdoEventTimer, DataType::u16, 0);
  slave_.set_state(5);
  start(settings);
  loop_.advance(20ms);
  ASSERT_EQ(status().boot_result, BootResult::other_vendor) << status().boot_text;
  loop_.advance(4975ms);
  slave_.heartbeat_off(true);  // The next look comes before the heartbeat that tells of the stop.
  const auto sent = command(NmtCommand::pre_operational);
  slave_.set({0x1018, 1}, DataType::u32, 0x91);
  loop_.advance(100ms);
  slave_.heartbeat_off(false);
  loop_.advance(20s, 10ms);
  ASSERT_TRUE(sent.done() && sent.get().has_value());
  EXPECT_EQ(slave_.value(kTpdoEventTimer), 100U) << "the reconfiguration did not take place";
  EXPECT_EQ(starts(), 0);
}

/// A node whose heartbeat answers an NMT command in the same turn of the loop.
class PromptNodeTest : public NodeLifeBench, private LinkEvents {
 protected:
  void SetUp() override { link_->open(*this); }
  void TearDown() override { link_->close(); }

 private:
  void on_frames(std::span<const Received> frames) override {
    for (const Received& received : frames) {
      if (received.frame.id == 0) {
        const std::uint8_t state = received.frame.data[0] == 1 ? 5 : 127;
        static_cast<void>(link_->send(make_frame(0x705, std::array{state})));
      }
    }
  }
  void on_echo(const Received&) override {}
  void on_bus_state(const BusState&) override {}
  void on_frames_lost(std::uint32_t) override {}

  std::unique_ptr<Link> link_ = wire_.connect();
};

TEST_F(PromptNodeTest, IsStartedAfterItsReconfiguration) {
  NodeSettings settings = bench_settings();
  settings.reconfigure_running = true;
  running(settings);
  slave_.set(kMapping, DataType::u32, kOtherMapping);
  start(settings);
  ASSERT_TRUE(wait_online(5s));
  EXPECT_EQ(nmt_heard(), (std::vector<Frame>{nmt(128), nmt(1)}));
  EXPECT_EQ(status().nmt, NmtState::operational);
}

TEST_F(PromptNodeTest, StartedByUsIsNotTakenForStartedBySomebodyElse) {
  install(bench_settings());
  start(bench_settings());
  slave_.boot_up();
  ASSERT_TRUE(wait_online());
  EXPECT_EQ(events_.arrivals, std::vector<Arrival>{Arrival::booted});
}

}  // namespace
}  // namespace canopen
