// An NMT stop or pre-operational that was answered stands: nothing that was begun before it, and nothing that begins
// by itself, starts the node behind it.

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "tests/unit/canopen/node_life_bench.h"

namespace canopen {
namespace {

using namespace std::chrono_literals;

constexpr Raw kStands = 0x0650;
constexpr Raw kStandsWithFault = 0x0658;

class NodeStopTest : public NodeLifeBench {
 protected:
  /// It is served, and has left operational by itself just now.
  void serve_until_it_leaves(bool restart, Raw status_word = kStands) {
    NodeSettings settings = with_motor();
    settings.restart = restart;
    slave_.set(kStatusWord, DataType::u16, status_word);
    bring_online(settings);
    loop_.advance(2s);
    leave_operational();
  }
  /// The command has been answered well; two minutes later it still stands.
  void expect_it_stands(NmtCommand what) {
    const auto stopped = command(what);
    loop_.advance(5ms);
    ASSERT_TRUE(stopped.done());
    ASSERT_TRUE(stopped.get().has_value()) << to_string(stopped.get().error());
    loop_.advance(120s, 10ms);
    EXPECT_EQ(nmt_heard(), std::vector<Frame>{nmt(static_cast<std::uint8_t>(what))});
    EXPECT_NE(slave_.state(), 5);
  }
};

TEST_F(NodeStopTest, BehindAStartThatIsBeingBooted) {
  serve_until_it_leaves(false);
  slave_.delay_answers(20ms);
  const auto started = command(NmtCommand::start);
  loop_.advance(100ms);
  expect_it_stands(NmtCommand::pre_operational);
  ASSERT_TRUE(started.done());
  EXPECT_EQ(started.get().error().kind, ErrorKind::offline);
  EXPECT_NE(started.get().error().detail.find("a stop came"), std::string::npos) << started.get().error().detail;
}

TEST_F(NodeStopTest, BeforeARestartIsDue) {
  serve_until_it_leaves(true);
  loop_.advance(2s, 10ms);
  expect_it_stands(NmtCommand::pre_operational);
  EXPECT_NE(status().boot_text.find("before an NMT start command"), std::string::npos) << status().boot_text;
}

TEST_F(NodeStopTest, WhileTheMotorIsLookedAtForARestart) {
  serve_until_it_leaves(true);
  slave_.delay_answers(100ms);
  loop_.advance(5050ms, 10ms);
  expect_it_stands(NmtCommand::pre_operational);
}

TEST_F(NodeStopTest, WhileTheMotorIsLookedAtInVain) {
  serve_until_it_leaves(true, kStandsWithFault);
  slave_.delay_answers(100ms);
  loop_.advance(5050ms, 10ms);
  const auto stopped = command(NmtCommand::pre_operational);
  loop_.advance(1s, 10ms);
  ASSERT_TRUE(stopped.done() && stopped.get().has_value());
  slave_.set(kStatusWord, DataType::u16, kStands);
  loop_.advance(120s, 10ms);
  EXPECT_EQ(nmt_heard(), std::vector<Frame>{nmt(128)});
}

TEST_F(NodeStopTest, WhileARestartIsBeingConfigured) {
  serve_until_it_leaves(true);
  slave_.delay_answers(20ms);
  loop_.advance(5200ms, 10ms);
  expect_it_stands(NmtCommand::pre_operational);
}

TEST_F(NodeStopTest, RightBeforeTheStartOfARestart) {
  serve_until_it_leaves(true);
  slave_.delay_answers(20ms);
  loop_.advance(5s, 10ms);
  const auto looks = [this] {
    const std::vector<ObjectAddress> reads = slave_.reads();
    return std::count(reads.begin(), reads.end(), kControlWord);
  };
  ASSERT_TRUE(loop_.advance_until([&] { return looks() >= 2; }, 3s));
  expect_it_stands(NmtCommand::stop);
}

TEST_F(NodeStopTest, OutlastsOurOwnInterfaceBeingDown) {
  bring_online(bench_settings());
  ASSERT_TRUE(command_now(NmtCommand::pre_operational).has_value());
  loop_.advance(3s);
  slave_.forget_heard();
  wire_.set_state(BusState{});
  loop_.advance(2s);
  wire_.set_state({BusCondition::error_active, 0, 0});
  loop_.advance(60s, 10ms);
  EXPECT_TRUE(nmt_heard().empty());
  EXPECT_TRUE(status().online);
  EXPECT_EQ(status().nmt, NmtState::pre_operational);
}

TEST_F(NodeStopTest, OneThatCouldNotLeaveForgetsNoOtherMaster) {
  serve_until_it_leaves(true);
  closed_ = true;
  const auto stopped = command(NmtCommand::pre_operational);
  loop_.advance(100ms);
  slave_.send(0x000, {128, 0});
  loop_.advance(1s, 10ms);
  ASSERT_TRUE(stopped.done() && stopped.get().has_error());
  closed_ = false;
  loop_.advance(60s, 10ms);
  EXPECT_TRUE(nmt_heard().empty());
}

TEST_F(NodeStopTest, AStartOfAStoppedDriveWhoseBootOutlastsItsDeadlineStillEndsInAStart) {
  bring_online(bench_settings());
  ASSERT_TRUE(command_now(NmtCommand::stop).has_value());
  loop_.advance(3s);
  wire_.set_state(BusState{});
  loop_.advance(100ms);
  wire_.set_state({BusCondition::error_active, 0, 0});
  loop_.advance(3s, 10ms);
  slave_.forget_heard();
  slave_.delay_answers(100ms);
  const auto started = command(NmtCommand::start);
  loop_.advance(801ms);
  ASSERT_TRUE(started.done());
  EXPECT_TRUE(started.get().error().outcome_unknown) << to_string(started.get().error());
  ASSERT_TRUE(wait_online(10s));
  EXPECT_EQ(nmt_heard(), (std::vector<Frame>{nmt(128), nmt(1)}));
}

}  // namespace
}  // namespace canopen
