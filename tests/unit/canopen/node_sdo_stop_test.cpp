// Stops by SDO to a drive in whatever stage: while the bus is up none is refused.

#include <algorithm>
#include <string>
#include <vector>

#include "tests/unit/canopen/node_life_bench.h"

namespace canopen {
namespace {

using namespace std::chrono_literals;

constexpr Raw kShutdown = 6;

class NodeSdoStopTest : public NodeLifeBench {
 protected:
  Sent stop(Duration within = kDeadline) {
    return support::spawn(loop_.executor(),
                          node_->write_stop(kControlWord, DataType::u16, kShutdown, Clock::now() + within));
  }
  [[nodiscard]] long stops_heard() const {
    const std::vector<ObjectAddress> writes = slave_.writes();
    return std::count(writes.begin(), writes.end(), kControlWord);
  }
  /// The drive does it and says so.
  void expect_carried_out() {
    const long before = stops_heard();
    const auto stopping = stop();
    loop_.advance(150ms);
    ASSERT_TRUE(stopping.done());
    EXPECT_TRUE(stopping.get().has_value()) << to_string(stopping.get().error());
    EXPECT_EQ(stops_heard(), before + 1);
    EXPECT_EQ(slave_.value(kControlWord), kShutdown);
  }
  /// It was sent once, and no answer came.
  void expect_sent_in_vain() {
    const long before = stops_heard();
    const auto stopping = stop();
    loop_.advance(801ms);
    ASSERT_TRUE(stopping.done());
    ASSERT_TRUE(stopping.get().has_error());
    const Error& error = stopping.get().error();
    EXPECT_EQ(error.kind, ErrorKind::offline) << to_string(error);
    EXPECT_TRUE(error.outcome_unknown);
    EXPECT_NE(error.detail.find("sent, not confirmed"), std::string::npos) << error.detail;
    EXPECT_EQ(stops_heard(), before + 1);
  }
};

TEST_F(NodeSdoStopTest, InService) {
  bring_online(bench_settings());
  expect_carried_out();
  slave_.mute(kControlWord);
  const auto stopping = stop();
  loop_.advance(801ms);
  ASSERT_TRUE(stopping.done());
  EXPECT_EQ(stopping.get().error().kind, ErrorKind::timeout) << "it is not offline";
  EXPECT_TRUE(stopping.get().error().outcome_unknown);
}

TEST_F(NodeSdoStopTest, ToADriveThatLeftOperational) {
  bring_online(bench_settings());
  leave_operational();
  expect_carried_out();
  slave_.mute(kControlWord);
  expect_sent_in_vain();
}

TEST_F(NodeSdoStopTest, ToADriveThatCouldNotBeConfigured) {
  install(bench_settings());
  slave_.set({0x1800, 5}, DataType::u16, 0);
  slave_.ignore_write({0x1800, 5});
  boot(bench_settings());
  ASSERT_EQ(status().boot_result, BootResult::not_configured);
  expect_carried_out();
  EXPECT_EQ(status().boot_result, BootResult::not_configured);
}

TEST_F(NodeSdoStopTest, ToADriveThatIsLeftAlone) {
  running(bench_settings());
  slave_.set(kMapping, DataType::u32, kOtherMapping);
  start(bench_settings());
  loop_.advance(2s);
  ASSERT_EQ(status().boot_result, BootResult::left_alone);
  expect_carried_out();
}

TEST_F(NodeSdoStopTest, ToADriveThatIsLost) {
  bring_online(bench_settings());
  without_heartbeat();
  loop_.advance(2100ms);
  ASSERT_TRUE(status().lost);
  slave_.mute_sdo(true);
  slave_.forget_heard();
  const auto life = [this] { slave_.send(0x706, {5}); };  // Another node keeps the bus alive.
  life();
  const auto stopping = stop();
  for (int i = 0; i < 9; ++i) {
    life();
    loop_.advance(100ms);
  }
  ASSERT_TRUE(stopping.done());
  EXPECT_EQ(stopping.get().error().kind, ErrorKind::offline);
  EXPECT_TRUE(stopping.get().error().outcome_unknown) << to_string(stopping.get().error());
  EXPECT_EQ(stops_heard(), 1);
}

TEST_F(NodeSdoStopTest, OnABusThatIsDownNothingIsSent) {
  bring_online(bench_settings());
  wire_.set_state(BusState{});
  loop_.advance(2ms);
  const auto stopping = stop();
  loop_.settle();
  ASSERT_TRUE(stopping.done());
  EXPECT_EQ(stopping.get().error().kind, ErrorKind::offline);
  EXPECT_FALSE(stopping.get().error().outcome_unknown);
  wire_.set_state({BusCondition::error_active, 0, 0});
  loop_.advance(3s);
  EXPECT_EQ(stops_heard(), 0);
}

TEST_F(NodeSdoStopTest, ABootGoesOnBehindIt) {
  for (const Duration at : {5ms, 55ms, 105ms, 155ms, 205ms}) {
    slave_.delay_answers({});
    install(bench_settings());
    slave_.set(kMapping, DataType::u32, kOtherMapping);
    slave_.delay_answers(20ms);
    start(bench_settings());
    slave_.boot_up();
    loop_.advance(at);
    ASSERT_FALSE(status().online);
    expect_carried_out();
    EXPECT_TRUE(wait_online()) << status().boot_text;
    for (const NodeStatus& told : events_.statuses) {
      EXPECT_FALSE(is_letter(told.boot_result)) << told.boot_text;
    }
    const auto stopped = support::spawn(loop_.executor(), node_->stop());
    loop_.settle();
    ASSERT_TRUE(*stopped);
    slave_.set_state(127);
  }
}

TEST_F(NodeSdoStopTest, ABootIsNotFailedByAStopThatTheDriveDoesNotAnswer) {
  install(bench_settings());
  slave_.mute(kControlWord);
  slave_.delay_answers(20ms);
  start(bench_settings());
  slave_.boot_up();
  loop_.advance(50ms);
  expect_sent_in_vain();
  EXPECT_TRUE(wait_online()) << status().boot_text;
}

TEST_F(NodeSdoStopTest, ABootUpLosesNoneThatWaits) {
  bring_online(bench_settings());
  slave_.mute(kTarget);
  const auto reading = support::spawn(loop_.executor(), node_->read(kTarget, DataType::i16));
  loop_.advance(10ms);
  const auto stopping = stop();
  loop_.advance(10ms);
  slave_.boot_up();
  loop_.advance(20ms);
  ASSERT_TRUE(stopping.done());
  EXPECT_TRUE(stopping.get().has_value()) << to_string(stopping.get().error());
  EXPECT_EQ(slave_.value(kControlWord), kShutdown);
}

TEST_F(NodeSdoStopTest, TheEndOfTheNodeSendsNone) {
  bring_online(bench_settings());
  closed_ = true;
  const auto stopping = stop();
  loop_.advance(10ms);
  const auto ended = support::spawn(loop_.executor(), node_->stop());
  loop_.advance(10ms);
  ASSERT_TRUE(*ended && stopping.done());
  EXPECT_EQ(stopping.get().error().kind, ErrorKind::offline);
  EXPECT_FALSE(stopping.get().error().outcome_unknown);
  closed_ = false;
  const auto later = stop();
  loop_.advance(100ms);
  ASSERT_TRUE(later.done() && later.get().has_error());
  EXPECT_EQ(stops_heard(), 0);
}

TEST_F(NodeSdoStopTest, ItTellsWhetherAWriteMayStillBeCarriedOut) {
  bring_online(bench_settings());
  EXPECT_FALSE(node_->may_still_act(kControlWord));
  slave_.mute(kControlWord);
  const auto writing = write(15, 100ms);
  loop_.advance(10ms);
  EXPECT_TRUE(node_->may_still_act(kControlWord)) << "under way";
  EXPECT_FALSE(node_->may_still_act(kTarget));
  loop_.advance(100ms);
  ASSERT_TRUE(writing.done());
  EXPECT_TRUE(node_->may_still_act(kControlWord)) << "unanswered";
  const auto reading = support::spawn(loop_.executor(), node_->read(kTarget, DataType::i16));
  loop_.advance(10ms);
  ASSERT_TRUE(reading.done());
  EXPECT_FALSE(node_->may_still_act(kControlWord)) << "its time is over: servers answer in order";
}

}  // namespace
}  // namespace canopen
