// What was half done with a node when it was started, rebooted, lost or left by somebody else.

#include <gtest/gtest.h>

#include <vector>

#include "tests/unit/canopen/node_life_bench.h"

namespace canopen {
namespace {

using namespace std::chrono_literals;

class HalfDoneTest : public NodeLifeBench {
 protected:
  /// In the middle of a configuration that writes; the slave answers each request after 20 ms.
  void configure_half() {
    install(bench_settings());
    slave_.set(kMapping, DataType::u32, kOtherMapping);
    slave_.delay_answers(20ms);
    start(bench_settings());
    slave_.boot_up();
    ASSERT_TRUE(loop_.advance_until([this] { return slave_.writes().size() == 3; }, 2s));
  }
  /// Running with another mapping, which may be changed.
  static NodeSettings reconfiguring() {
    NodeSettings settings = bench_settings();
    settings.reconfigure_running = true;
    return settings;
  }
};

TEST_F(HalfDoneTest, StartedBySomebodyElseItIsNotWrittenToAnyMore) {
  configure_half();
  says(5);
  const std::size_t before = slave_.writes().size();
  loop_.advance(10s, 5ms);
  EXPECT_EQ(slave_.writes().size(), before);
  EXPECT_TRUE(nmt_heard().empty());
  expect_letter(BootResult::left_alone,
                "our configuration of it was interrupted: 3 objects were written, the last 0x1A00:");
}

TEST_F(HalfDoneTest, ItsConfigurationGoesOnWhenItLeavesAgain) {
  configure_half();
  says(5);
  loop_.advance(3s, 5ms);
  ASSERT_EQ(status().boot_result, BootResult::left_alone);
  says(127);
  ASSERT_TRUE(wait_online(5s)) << status().boot_text;
  EXPECT_EQ(slave_.value(kMapping), kWantedMapping);
  EXPECT_EQ(nmt_heard(), std::vector<Frame>{nmt(1)});
}

TEST_F(HalfDoneTest, ItIsForgottenWithALoss) {
  install(bench_settings());
  slave_.set(kMapping, DataType::u32, kOtherMapping);
  slave_.ignore_write(kMapping);
  start(bench_settings());
  slave_.boot_up();
  loop_.advance(2s);
  ASSERT_EQ(status().boot_result, BootResult::not_configured) << status().boot_text;
  slave_.unplug(true);
  loop_.advance(60s, 10ms);
  ASSERT_TRUE(status().lost);
  install(bench_settings());  // Switched off and on unseen, and started by another master.
  slave_.set(kTpdoEventTimer, DataType::u16, 0);
  slave_.set_state(5);
  slave_.unplug(false);
  slave_.forget_heard();
  loop_.advance(10s, 10ms);
  ASSERT_EQ(status().boot_result, BootResult::left_alone) << status().boot_text;
  EXPECT_FALSE(told("interrupted")) << status().boot_text;
  leave_operational();
  loop_.advance(20s, 10ms);
  EXPECT_TRUE(nmt_heard().empty()) << "nothing of ours is to go on";
}

TEST_F(HalfDoneTest, ADriveThatIsStartedAndLeavesAllTheTimeIsLetBe) {
  install(bench_settings());
  slave_.set(kMapping, DataType::u32, kOtherMapping);
  slave_.delay_answers(2ms);
  start(bench_settings());
  for (int i = 0; i < 100; ++i) {
    says(5);
    loop_.advance(49ms);
    says(127);
    loop_.advance(49ms);
  }
  expect_let_be();
}

// What was expected before a boot-up does not come back with the end of what was under way then.
TEST_F(HalfDoneTest, ABootUpWhilePreOperationalOfAReconfigurationWaitsMeansABoot) {
  running(reconfiguring());
  slave_.set(kMapping, DataType::u32, kOtherMapping);
  when_read(kMapping, [this] { closed_ = true; });
  start(reconfiguring());
  loop_.advance(100ms);
  ASSERT_TRUE(closed_);
  slave_.script({});
  slave_.boot_up();
  loop_.advance(1ms);
  closed_ = false;
  loop_.advance(20s, 10ms);
  EXPECT_EQ(nmt_heard(), std::vector<Frame>{nmt(1)}) << "booted, said to be well, and never started";
  EXPECT_EQ(status().boot_result, BootResult::ok) << status().boot_text;
}

TEST_F(HalfDoneTest, PreOperationalOfAReconfigurationWhoseEchoIsNotSeenIsNoSurprise) {
  running(reconfiguring());
  slave_.set(kMapping, DataType::u32, kOtherMapping);
  slave_.delay_answers(5ms);
  when_read(kMapping, [this] { wire_.withhold_echoes(true); });
  start(reconfiguring());
  loop_.advance(300ms);
  slave_.script({});
  wire_.withhold_echoes(false);
  ASSERT_EQ(nmt_heard(), std::vector<Frame>{nmt(128)});
  loop_.advance(30s, 10ms);
  EXPECT_TRUE(status().online) << status().boot_text;
  EXPECT_EQ(slave_.value(kMapping), kWantedMapping);
}

TEST_F(HalfDoneTest, AStartOfABootWhoseEchoIsNotSeenIsNoSurprise) {
  install(bench_settings());
  when_read(kLastRead, [this] { wire_.withhold_echoes(true); });
  start(bench_settings());
  slave_.boot_up();
  loop_.advance(700ms);
  ASSERT_EQ(nmt_heard(), std::vector<Frame>{nmt(1)});
  wire_.withhold_echoes(false);
  slave_.script({});
  loop_.advance(10s, 10ms);
  EXPECT_TRUE(status().online) << status().boot_text;
  EXPECT_EQ(nmt_heard(), std::vector<Frame>{nmt(1)});
}

TEST_F(HalfDoneTest, AStartCommandThatLeftBeforeABootUpIsNotExpectedAfterIt) {
  bring_online(bench_settings());
  wire_.withhold_echoes(true);
  const auto starting = command(NmtCommand::start);
  loop_.advance(10ms);
  slave_.delay_answers(200ms);  // The boot takes longer than the time in which a command is to show.
  slave_.boot_up();
  loop_.advance(140ms);
  wire_.withhold_echoes(false);
  loop_.advance(20s, 10ms);
  EXPECT_EQ(nmt_heard(), (std::vector<Frame>{nmt(1), nmt(1)})) << "the second is that of the boot";
  EXPECT_TRUE(status().online) << status().boot_text;
  EXPECT_EQ(status().nmt, NmtState::operational);
}

TEST_F(HalfDoneTest, AMessageFromBeforeAResetIsNoSignOfItsState) {
  bring_online(bench_settings());
  slave_.ignore_nmt(true);
  slave_.heartbeat_off(true);
  ASSERT_TRUE(command_now(NmtCommand::reset_node).has_value());
  slave_.send(0x705, {5});
  slave_.mute_sdo(true);
  loop_.advance(1700ms);
  slave_.mute_sdo(false);
  slave_.ignore_nmt(false);
  slave_.heartbeat_off(false);
  says(127);
  ASSERT_TRUE(wait_online(3s)) << status().boot_text;
  EXPECT_EQ(nmt_heard(), (std::vector<Frame>{nmt(129), nmt(1)}));
}

}  // namespace
}  // namespace canopen
