// Commands to a node in service: NMT, SDO, RPDO.

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "canopen/node/remote_node.h"
#include "tests/unit/canopen/node_bench.h"

namespace canopen {
namespace {

using namespace std::chrono_literals;

class NodeCommandsTest : public NodeCommandBench {};

TEST_F(NodeCommandsTest, StopByCommandIsNoSurprise) {
  bring_online(bench_settings());
  ASSERT_TRUE(command_now(NmtCommand::stop).has_value());
  loop_.advance(60s, 10ms);
  EXPECT_EQ(status().nmt, NmtState::stopped);
  EXPECT_TRUE(status().online);
  EXPECT_EQ(status().boot_result, BootResult::ok);
  EXPECT_EQ(nmt_heard(), std::vector<Frame>{nmt(2)});
  const auto reading = support::spawn(loop_.executor(), node_->read(kControlWord, DataType::u16));
  loop_.settle();
  ASSERT_TRUE(reading.done());
  EXPECT_EQ(reading.get().error().kind, ErrorKind::offline);
  ASSERT_TRUE(command_now(NmtCommand::start).has_value());
  loop_.advance(1s);
  EXPECT_EQ(status().nmt, NmtState::operational);
  EXPECT_EQ(nmt_heard(), (std::vector<Frame>{nmt(2), nmt(1)}));
  EXPECT_TRUE(slave_.writes().empty());
}

TEST_F(NodeCommandsTest, HeartbeatThatCrossesAStopIsNoStart) {
  bring_online(bench_settings());
  slave_.send(0x705, {5});  // Arrives after the command was given and before it has left.
  ASSERT_TRUE(command_now(NmtCommand::pre_operational).has_value());
  loop_.advance(3s);
  EXPECT_EQ(status().nmt, NmtState::pre_operational);
  EXPECT_EQ(status().boot_result, BootResult::ok) << status().boot_text;
}

TEST_F(NodeCommandsTest, PreOperationalAfterALossMayBeARebootAndIsStarted) {
  bring_online(bench_settings());
  ASSERT_TRUE(command_now(NmtCommand::pre_operational).has_value());
  loop_.advance(1s);
  lose();
  slave_.unplug(false);
  slave_.set({0x1800, 5}, DataType::u16, 0);
  ASSERT_TRUE(wait_online());
  EXPECT_EQ(slave_.value({0x1800, 5}), 100U);
  EXPECT_EQ(nmt_heard(), std::vector<Frame>{nmt(1)});
}

TEST_F(NodeCommandsTest, AStopByCommandOutlastsALoss) {
  bring_online(bench_settings());
  ASSERT_TRUE(command_now(NmtCommand::stop).has_value());
  loop_.advance(1s);
  lose();
  slave_.unplug(false);
  loop_.advance(30s, 10ms);
  EXPECT_FALSE(status().online);
  EXPECT_EQ(status().nmt, NmtState::stopped);
  EXPECT_NE(status().boot_text.find("found stopped"), std::string::npos) << status().boot_text;
  EXPECT_TRUE(nmt_heard().empty());
  const auto started = command(NmtCommand::start, 5s);
  ASSERT_TRUE(wait_online(5s));
  ASSERT_TRUE(started.done());
  EXPECT_TRUE(started.get().has_value());
  EXPECT_EQ(nmt_heard(), (std::vector<Frame>{nmt(128), nmt(1)}));
}

TEST_F(NodeCommandsTest, QuickStopAndStartIsNoSurprise) {
  bring_online(bench_settings());
  ASSERT_TRUE(command_now(NmtCommand::pre_operational).has_value());
  ASSERT_TRUE(command_now(NmtCommand::start).has_value());
  slave_.send(0x705, {0x7F});  // From between the two.
  loop_.advance(2s);
  EXPECT_EQ(status().boot_result, BootResult::ok);
  EXPECT_EQ(status().nmt, NmtState::operational);
}

TEST_F(NodeCommandsTest, ResetByCommandIsFollowedByABoot) {
  bring_online(bench_settings());
  ASSERT_TRUE(command_now(NmtCommand::reset_node).has_value());
  EXPECT_FALSE(status().online);
  ASSERT_TRUE(wait_online());
  EXPECT_EQ(nmt_heard(), (std::vector<Frame>{nmt(129), nmt(1)}));
  EXPECT_EQ(status().boot_ups, 2U);
}

TEST_F(NodeCommandsTest, ResetWithoutBootUpMessageIsFollowedByABootToo) {
  bring_online(bench_settings());
  slave_.ignore_nmt(true);
  ASSERT_TRUE(command_now(NmtCommand::reset_node).has_value());
  slave_.set_state(127);
  slave_.ignore_nmt(false);
  ASSERT_TRUE(wait_online());
  EXPECT_EQ(nmt_heard(), (std::vector<Frame>{nmt(129), nmt(1)}));
  EXPECT_EQ(status().boot_ups, 1U);
}

TEST_F(NodeCommandsTest, NmtCommandGoesToAMissingDriveButStartWaitsForItsBoot) {
  install(bench_settings());
  slave_.set_state(127);
  bring_online(bench_settings());
  lose();
  slave_.unplug(false);
  slave_.heartbeat_off(true);
  slave_.mute_sdo(true);
  slave_.forget_heard();
  EXPECT_EQ(command_now(NmtCommand::start).error().kind, ErrorKind::offline);
  slave_.send(0x706, {5});  // Commands leave only while the bus shows life.
  EXPECT_TRUE(command_now(NmtCommand::reset_node).has_value());
  EXPECT_EQ(nmt_heard(), std::vector<Frame>{nmt(129)});
}

TEST_F(NodeCommandsTest, WritesAreConfirmedByTheDrive) {
  bring_online(bench_settings());
  const auto writing = write(0x0F);
  loop_.advance(2ms);
  ASSERT_TRUE(writing.done());
  EXPECT_TRUE(writing.get().has_value());
  EXPECT_EQ(slave_.value(kControlWord), 0x0FU);
}

TEST_F(NodeCommandsTest, CommandThatWaitsAtABootUpNeverLeaves) {
  bring_online(bench_settings());
  slave_.mute_sdo(true);
  const auto reading = support::spawn(loop_.executor(), node_->read(kTarget, DataType::i16));
  const auto writing = write(0x0F);
  loop_.advance(10ms);
  slave_.mute_sdo(false);
  slave_.boot_up();
  loop_.advance(2ms);
  ASSERT_TRUE(writing.done());
  EXPECT_EQ(writing.get().error().kind, ErrorKind::offline);
  EXPECT_FALSE(writing.get().error().outcome_unknown);
  loop_.advance(3s);
  EXPECT_EQ(slave_.value(kControlWord), 0U);
}

TEST_F(NodeCommandsTest, RpdoNeedsEveryField) {
  bring_online(bench_settings());
  EXPECT_EQ(rpdo_now({target(100)}).error().kind, ErrorKind::incomplete);
  EXPECT_TRUE(slave_.heard_on(0x205).empty());
  EXPECT_TRUE(rpdo_now({control(0x0F), target(100)}).has_value());
  EXPECT_EQ(rpdo_now({target(100)}).error().kind, ErrorKind::incomplete) << "nothing is added to what is given";
  ASSERT_EQ(slave_.heard_on(0x205).size(), 1U);
  EXPECT_EQ(slave_.heard_on(0x205)[0], make_frame(0x205, std::vector<std::uint8_t>{0x0F, 0, 100, 0}));
}

TEST_F(NodeCommandsTest, RpdosAreRefusedWhileItIsNotOperational) {
  bring_online(bench_settings());
  ASSERT_TRUE(command_now(NmtCommand::pre_operational).has_value());
  EXPECT_EQ(rpdo_now({control(0x0F), target(100)}).error().kind, ErrorKind::offline);
  ASSERT_TRUE(command_now(NmtCommand::start).has_value());
  loop_.advance(1s);
  ASSERT_EQ(status().nmt, NmtState::operational);
  lose();
  EXPECT_EQ(rpdo_now({control(0x0F), target(100)}).error().kind, ErrorKind::offline);
  EXPECT_TRUE(slave_.heard_on(0x205).empty());
}

TEST_F(NodeCommandsTest, ARpdoThatWaitsIsWithdrawnWithTheCommand) {
  bring_online(bench_settings());
  ASSERT_TRUE(rpdo_now({control(0x0F), target(100)}).has_value());
  slave_.forget_heard();
  wire_.withhold_echoes(true);
  const auto blocking = write(0x0F, 50ms);  // Of commands only one is in the kernel at a time.
  const auto waiting = rpdo({control(0x0F), target(200)});
  loop_.settle();
  node_->withdraw_command();
  loop_.settle();
  ASSERT_TRUE(waiting.done());
  EXPECT_EQ(waiting.get().error().kind, ErrorKind::timeout);
  EXPECT_TRUE(waiting.get().error().not_sent);
  EXPECT_FALSE(waiting.get().error().outcome_unknown);
  wire_.withhold_echoes(false);
  loop_.advance(3s);
  EXPECT_TRUE(slave_.heard_on(0x205).empty());
}

TEST_F(NodeCommandsTest, SupervisedRpdoIsRepeatedWithWhatIsTold) {
  NodeSettings settings = bench_settings();
  settings.rpdos[0].event_timer = std::uint16_t{300};
  bring_online(settings);
  loop_.advance(1s);
  EXPECT_TRUE(slave_.heard_on(0x205).empty());
  ASSERT_TRUE(rpdo_now({control(0x0F), target(100)}).has_value());
  slave_.forget_heard();
  loop_.advance(1s);
  EXPECT_EQ(slave_.heard_on(0x205),
            std::vector<Frame>(10, make_frame(0x205, std::vector<std::uint8_t>{0x0F, 0, 100, 0})));
  slave_.forget_heard();
  events_.repeated = {control(0x06), target(100)};  // A drive that came to a stop would trip otherwise.
  node_->repetition_changed();
  loop_.advance(1s);
  EXPECT_EQ(slave_.heard_on(0x205),
            std::vector<Frame>(10, make_frame(0x205, std::vector<std::uint8_t>{0x06, 0, 100, 0})));
  slave_.forget_heard();
  events_.repeated.clear();
  node_->repetition_changed();
  loop_.advance(1s);
  EXPECT_TRUE(slave_.heard_on(0x205).empty());
}

TEST_F(NodeCommandsTest, NothingIsRepeatedAfterABootUpALossOrLeavingOperationalWhateverIsTold) {
  NodeSettings settings = bench_settings();
  settings.rpdos[0].event_timer = std::uint16_t{300};
  bring_online(settings);
  const auto expect_silence = [&] {
    slave_.forget_heard();
    ASSERT_FALSE(events_.repeated.empty());
    loop_.advance(1s);
    ASSERT_TRUE(status().online);
    ASSERT_EQ(status().nmt, NmtState::operational);
    EXPECT_TRUE(slave_.heard_on(0x205).empty());
  };
  ASSERT_TRUE(rpdo_now({control(0x0F), target(100)}).has_value());
  slave_.boot_up();
  ASSERT_TRUE(wait_online());
  loop_.advance(1s);
  expect_silence();
  ASSERT_TRUE(rpdo_now({control(0x0F), target(100)}).has_value());
  ASSERT_TRUE(command_now(NmtCommand::pre_operational).has_value());
  ASSERT_TRUE(command_now(NmtCommand::start).has_value());
  loop_.advance(1s);
  expect_silence();
  ASSERT_TRUE(rpdo_now({control(0x0F), target(100)}).has_value());
  lose();
  slave_.unplug(false);
  ASSERT_TRUE(wait_online());
  expect_silence();
  ASSERT_TRUE(rpdo_now({control(0x0F), target(100)}).has_value());
  slave_.forget_heard();
  loop_.advance(1s);
  EXPECT_EQ(slave_.heard_on(0x205).size(), 10U) << "the next command is repeated again";
}

TEST_F(NodeCommandsTest, UnsupervisedRpdoIsNotRepeated) {
  bring_online(bench_settings());
  ASSERT_TRUE(rpdo_now({control(0x0F), target(100)}).has_value());
  loop_.advance(5s);
  EXPECT_EQ(slave_.heard_on(0x205).size(), 1U);
}

TEST_F(NodeCommandsTest, ReadIsRefusedAtOnceWhileNobodyAnswers) {
  install(bench_settings());
  slave_.unplug(true);
  start(bench_settings());
  loop_.advance(3s);
  const auto reading = support::spawn(loop_.executor(), node_->read(kControlWord, DataType::u16));
  loop_.settle();
  ASSERT_TRUE(reading.done());
  EXPECT_EQ(reading.get().error().kind, ErrorKind::offline);
  EXPECT_EQ(reading.get().error().node, kTestNode);
}

}  // namespace
}  // namespace canopen
