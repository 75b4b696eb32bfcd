// Finding a node at our start, or after the bus came back: learnt by listening and reading. What is found operational
// as wanted gets neither a write nor an NMT command.

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "tests/unit/canopen/node_bench.h"

namespace canopen {
namespace {

using namespace std::chrono_literals;

class StateSearchTest : public NodeBench {};

TEST_F(StateSearchTest, FoundPreOperationalItIsBooted) {
  install(bench_settings());
  slave_.set({0x1800, 5}, DataType::u16, 0);
  start(bench_settings());
  ASSERT_TRUE(wait_online());
  EXPECT_EQ(nmt_heard(), std::vector<Frame>{nmt(1)});
  EXPECT_EQ(events_.arrivals, std::vector<Arrival>{Arrival::booted});
}

TEST_F(StateSearchTest, FoundStoppedItIsLeftSoUntilAStartCommand) {
  install(bench_settings());
  slave_.set_state(4);
  slave_.script([this](const support::ScriptedSlave::Bytes&) {
    using Answers = std::vector<support::ScriptedSlave::Bytes>;
    return slave_.state() == 4 ? std::optional(Answers{}) : std::nullopt;
  });
  start(bench_settings());
  loop_.advance(30s, 10ms);
  expect_letter(BootResult::not_configured, "found stopped");
  EXPECT_FALSE(status().lost);
  const auto started = support::spawn(loop_.executor(), node_->command(NmtCommand::start, Clock::now() + 3s));
  ASSERT_TRUE(wait_online());
  ASSERT_TRUE(started.done());
  EXPECT_TRUE(started.get().has_value());
  EXPECT_EQ(nmt_heard(), (std::vector<Frame>{nmt(128), nmt(1)}));
}

TEST_F(StateSearchTest, AnSdoAnswerWithNothingElseMeansNotOperational) {
  install(bench_settings());
  slave_.set(kHeartbeatTime, DataType::u16, 0);
  start(bench_settings());
  loop_.advance(1499ms);
  EXPECT_TRUE(slave_.heard().empty()) << "only listening";
  ASSERT_TRUE(wait_online());
  EXPECT_EQ(slave_.reads().front(), kHeartbeatTime);
  EXPECT_EQ(slave_.value(kHeartbeatTime), 500U);
  EXPECT_FALSE(std::any_of(events_.statuses.begin(), events_.statuses.end(), [](const auto& s) { return s.lost; }));
}

TEST_F(StateSearchTest, OneGuardingRequestWithoutHeartbeat) {
  NodeSettings settings = bench_settings();
  settings.error_control.has_guarding = true;
  settings.error_control.heartbeat = Duration::zero();
  running(settings);
  slave_.set(kHeartbeatTime, DataType::u16, 0);
  slave_.answer_guarding(true);
  start(settings);
  loop_.advance(1550ms);
  const std::vector<Frame> requests = slave_.heard_on(0x705);
  ASSERT_EQ(requests.size(), 1U);
  EXPECT_TRUE(requests[0].remote);
  EXPECT_EQ(requests[0].size, 1U);
  EXPECT_EQ(status().nmt, NmtState::operational);
  EXPECT_TRUE(status().online);
  expect_untouched();
}

TEST_F(StateSearchTest, GuardingIsNoHeartbeat) {
  NodeSettings settings = bench_settings();
  settings.error_control.has_guarding = true;
  settings.error_control.policy = SetupPolicy::assume;
  running(settings);
  slave_.set(kHeartbeatTime, DataType::u16, 0);
  slave_.answer_guarding(true);
  start(settings);
  loop_.advance(4s);
  EXPECT_EQ(status().boot_result, BootResult::no_error_control) << status().boot_text;
  EXPECT_NE(status().boot_text.find("guarding is not supported"), std::string::npos) << status().boot_text;
  events_.statuses.clear();
  loop_.advance(60s, 10ms);
  EXPECT_TRUE(events_.statuses.empty()) << "nothing flaps";
  EXPECT_TRUE(events_.arrivals.empty());
  expect_untouched();
  slave_.set(kHeartbeatTime, DataType::u16, 500);
  EXPECT_TRUE(wait_online(70s)) << "it is looked at each minute by now";
  EXPECT_EQ(status().boot_result, BootResult::ok);
}

TEST_F(StateSearchTest, KnownByGuardingAndLeftAloneNothingFlaps) {
  NodeSettings settings = bench_settings();
  settings.error_control.has_guarding = true;
  running(settings);
  slave_.set(kHeartbeatTime, DataType::u16, 0);
  slave_.answer_guarding(true);
  start(settings);
  loop_.advance(3s);
  expect_left_alone("0x1017:00 heartbeat time: expected 500, found 0");
  events_.statuses.clear();
  loop_.advance(60s, 10ms);
  EXPECT_TRUE(events_.statuses.empty());
  slave_.unplug(true);
  EXPECT_TRUE(loop_.advance_until([this] { return status().lost; }, 10s));
}

TEST_F(StateSearchTest, NoGuardingRequestWhereAHeartbeatIsSet) {
  NodeSettings settings = bench_settings();
  settings.error_control.has_guarding = true;
  running(settings);
  without_heartbeat();
  start(settings);
  loop_.advance(2500ms);
  EXPECT_TRUE(slave_.heard_on(0x705).empty());
}

TEST_F(StateSearchTest, SlowHeartbeatIsWaitedFor) {
  running(bench_settings());
  slave_.set(kHeartbeatTime, DataType::u16, 4000);
  loop_.advance(10ms);  // Its heartbeat has just been.
  start(bench_settings());
  loop_.advance(3900ms);
  EXPECT_TRUE(slave_.writes().empty());
  loop_.advance(200ms);
  expect_left_alone("0x1017:00");
}

TEST_F(StateSearchTest, MissingDriveIsTold) {
  install(bench_settings());
  slave_.unplug(true);
  start(bench_settings());
  loop_.advance(1900ms);
  EXPECT_FALSE(status().lost);
  loop_.advance(200ms);
  EXPECT_TRUE(status().lost);
  EXPECT_FALSE(status().online);
  EXPECT_EQ(status().boot_result, BootResult::not_booted);
  EXPECT_EQ(status().heartbeat_losses, 0U) << "it was never heard";
}

TEST_F(StateSearchTest, MissingDriveIsAskedRarelyAndFoundLater) {
  install(bench_settings());
  slave_.set(kHeartbeatTime, DataType::u16, 0);
  slave_.mute_sdo(true);
  start(bench_settings());
  loop_.advance(60s, 10ms);
  EXPECT_GE(slave_.heard().size(), 8U);
  EXPECT_LE(slave_.heard().size(), 20U);
  slave_.mute_sdo(false);
  EXPECT_TRUE(wait_online(8s));
  EXPECT_FALSE(status().lost);
}

TEST_F(StateSearchTest, MissingDriveIsBootedAtItsBootUp) {
  install(bench_settings());
  slave_.unplug(true);
  start(bench_settings());
  loop_.advance(20s, 10ms);
  slave_.unplug(false);
  slave_.boot_up();
  EXPECT_TRUE(wait_online(1s));
}

TEST_F(StateSearchTest, BusThatComesBackIsListenedToAgain) {
  running(bench_settings());
  start(bench_settings());
  ASSERT_TRUE(wait_online());
  wire_.set_state({BusCondition::bus_off, 0, 0});
  loop_.settle();
  EXPECT_FALSE(status().online);
  EXPECT_EQ(status().nmt, NmtState::unknown);
  loop_.advance(1s);
  EXPECT_FALSE(status().lost);
  loop_.advance(1s);
  EXPECT_TRUE(status().lost);
  slave_.forget_heard();
  wire_.set_state({BusCondition::error_active, 0, 0});
  EXPECT_TRUE(wait_online(1s));
  EXPECT_FALSE(status().lost);
  EXPECT_EQ(events_.arrivals, (std::vector<Arrival>{Arrival::taken_over, Arrival::taken_over}));
  expect_untouched();
}

TEST_F(StateSearchTest, GivenUpDuringTheSearchItIsStillAskedAtItsEnd) {
  install(bench_settings());
  slave_.set(kHeartbeatTime, DataType::u16, 0);
  without_heartbeat();
  wire_.set_state({});
  start(bench_settings());
  wire_.set_state({BusCondition::error_active, 0, 0});  // Both times begin at the same moment.
  loop_.advance(1510ms);
  EXPECT_FALSE(slave_.heard_on(0x605).empty());
  slave_.heartbeat_off(false);
  EXPECT_TRUE(wait_online());
}

}  // namespace
}  // namespace canopen
