// SDO commands to a node that leaves operational meanwhile: what has not begun never leaves.

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/unit/canopen/node_bench.h"

namespace canopen {
namespace {

using namespace std::chrono_literals;
using support::Spawned;

class SdoCommandsTest : public NodeCommandBench {
 protected:
  Spawned<Result<Raw>> read(ObjectAddress object) {
    return support::spawn(loop_.executor(), node_->read(object, DataType::u16));
  }
  Spawned<Result<void>> zero_rpdo(Duration within) { return rpdo({control(0), target(0)}, within); }
  /// By itself, and told at once.
  void leave_operational() {
    slave_.set_state(127);
    slave_.send(0x705, {127});
    loop_.settle();
  }
  static void expect_withdrawn(const Spawned<Result<void>>& writing) {
    ASSERT_TRUE(writing.done());
    ASSERT_TRUE(writing.get().has_error());
    EXPECT_EQ(writing.get().error().kind, ErrorKind::offline);
    EXPECT_FALSE(writing.get().error().outcome_unknown);
    EXPECT_NE(writing.get().error().detail.find("withdrawn"), std::string::npos) << writing.get().error().detail;
  }
  void expect_never_written() {
    loop_.advance(3s);
    EXPECT_TRUE(slave_.writes().empty());
    EXPECT_EQ(slave_.value(kControlWord), 0U);
  }
};

TEST_F(SdoCommandsTest, BehindAPollItIsWithdrawnAndThePollGoesOn) {
  bring_online(bench_settings());
  slave_.mute_sdo(true);
  const auto reading = read(kTarget);
  const auto writing = write(0x0F);
  loop_.advance(10ms);
  slave_.mute_sdo(false);
  leave_operational();
  expect_withdrawn(writing);
  expect_never_written();
  ASSERT_TRUE(reading.done());
  EXPECT_TRUE(reading.get().has_value());
}

TEST_F(SdoCommandsTest, InTheTransmitQueueItIsWithdrawn) {
  bring_online(bench_settings());
  wire_.withhold_echoes(true);
  const auto blocking = zero_rpdo(50ms);  // Of commands only one is in the kernel at a time.
  const auto writing = write(0x0F);
  loop_.settle();
  leave_operational();
  expect_withdrawn(writing);
  wire_.withhold_echoes(false);
  expect_never_written();
}

TEST_F(SdoCommandsTest, OnceItHasLeftItIsAwaited) {
  bring_online(bench_settings());
  slave_.delay_answers(50ms);
  const auto writing = write(0x0F);
  loop_.advance(10ms);
  leave_operational();
  EXPECT_FALSE(writing.done());
  loop_.advance(50ms);
  ASSERT_TRUE(writing.done());
  EXPECT_TRUE(writing.get().has_value());
}

TEST_F(SdoCommandsTest, NmtStopComesBeforeWhatWaits) {
  bring_online(bench_settings());
  wire_.withhold_echoes(true);
  const auto blocking = zero_rpdo(50ms);
  const auto writing = write(0x0F);
  loop_.settle();
  const auto stopping = command(NmtCommand::pre_operational);
  loop_.settle();
  expect_withdrawn(writing);
  const auto later = write(0x0F);
  loop_.settle();
  ASSERT_TRUE(later.done()) << "refused at once";
  EXPECT_EQ(later.get().error().kind, ErrorKind::offline);
  wire_.withhold_echoes(false);
  expect_never_written();
}

TEST_F(SdoCommandsTest, AfterAnNmtStopItIsRefusedBeforeTheHeartbeatTells) {
  bring_online(bench_settings());
  const auto stopping = command(NmtCommand::pre_operational);
  loop_.advance(2ms);
  ASSERT_TRUE(stopping.done() && stopping.get().has_value());
  const auto writing = write(0x0F);
  const auto sending = zero_rpdo(800ms);
  loop_.settle();
  ASSERT_TRUE(writing.done() && sending.done());
  EXPECT_EQ(writing.get().error().kind, ErrorKind::offline);
  EXPECT_EQ(sending.get().error().kind, ErrorKind::offline);
  expect_never_written();
}

TEST_F(SdoCommandsTest, ADriveThatDoesNotObeyAnNmtStopTakesCommandsAgain) {
  bring_online(bench_settings());
  slave_.ignore_nmt(true);
  const auto stopping = command(NmtCommand::pre_operational);
  loop_.advance(2500ms);
  const auto writing = write(0x0F);
  loop_.advance(5ms);
  ASSERT_TRUE(writing.done());
  EXPECT_TRUE(writing.get().has_value());
}

TEST_F(SdoCommandsTest, AReadThatGoesUnansweredLeavesTimeForAStop) {
  bring_online(bench_settings());
  slave_.mute(kTarget);
  const auto reading = read(kTarget);
  loop_.advance(10ms);
  const auto writing = write(0x06);
  loop_.advance(600ms);
  ASSERT_TRUE(writing.done());
  EXPECT_TRUE(writing.get().has_value());
  EXPECT_FALSE(reading.done());
  loop_.advance(1s);
  ASSERT_TRUE(reading.done());
  EXPECT_EQ(reading.get().error().kind, ErrorKind::timeout);
}

}  // namespace
}  // namespace canopen
