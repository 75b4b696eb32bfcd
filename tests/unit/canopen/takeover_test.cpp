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

class TakeoverTest : public NodeBench {};

TEST_F(TakeoverTest, OperationalAsWantedByHeartbeat) {
  running(bench_settings());
  start(bench_settings());
  loop_.advance(20ms);
  EXPECT_TRUE(status().online);
  EXPECT_TRUE(status().configured);
  EXPECT_EQ(status().nmt, NmtState::operational);
  EXPECT_EQ(events_.arrivals, std::vector<Arrival>{Arrival::taken_over});
  EXPECT_TRUE(node_->tpdo_verified(1));
  loop_.advance(10s, 10ms);
  EXPECT_TRUE(status().online);
  expect_untouched();
}

/// Nothing but its TPDOs tells what it does.
NodeSettings without_error_control() {
  NodeSettings settings = bench_settings();
  settings.error_control.heartbeat = Duration::zero();
  return settings;
}

TEST_F(TakeoverTest, ATpdoMeansOperationalWhereNoErrorControlTells) {
  running(without_error_control());
  slave_.set(kHeartbeatTime, DataType::u16, 0);
  start(without_error_control());
  loop_.advance(100ms);
  EXPECT_FALSE(status().online);
  EXPECT_TRUE(slave_.reads().empty());
  send_tpdo(0x27, 1450);
  loop_.advance(10ms);
  EXPECT_TRUE(status().online) << status().boot_text;
  EXPECT_EQ(slave_.reads().front(), kHeartbeatTime);
  EXPECT_EQ(events_.arrivals, std::vector<Arrival>{Arrival::taken_over});
  expect_untouched();
}

TEST_F(TakeoverTest, AHeartbeatDecidesWhateverTpdosComeBefore) {
  install(bench_settings());
  slave_.set({0x1800, 5}, DataType::u16, 0);
  loop_.advance(10ms);  // Its heartbeat has just been.
  start(bench_settings());
  send_tpdo(0x27, 1450);
  loop_.advance(400ms);
  EXPECT_TRUE(slave_.writes().empty());
  EXPECT_FALSE(status().online);
  ASSERT_TRUE(wait_online()) << "it said pre-operational";
  EXPECT_EQ(slave_.value({0x1800, 5}), 100U);
  EXPECT_EQ(events_.arrivals, std::vector<Arrival>{Arrival::booted});
}

TEST_F(TakeoverTest, TpdosFromBeforeTheEndAreNoValues) {
  running(without_error_control());
  slave_.set(kHeartbeatTime, DataType::u16, 0);
  slave_.delay_answers(5ms);
  start(without_error_control());
  send_tpdo(0x27, 1);
  loop_.advance(10ms);
  send_tpdo(0x27, 2);
  EXPECT_FALSE(status().online);
  ASSERT_TRUE(wait_online());
  EXPECT_TRUE(events_.tpdos.empty());
  send_tpdo(0x27, 3);
  ASSERT_EQ(events_.tpdos.size(), 1U);
  EXPECT_EQ(events_.tpdos[0].second, (std::vector<Raw>{0x27, 3}));
}

TEST_F(TakeoverTest, LiveWithinASecond) {
  running(bench_settings());
  start(bench_settings());
  slave_.delay_answers(1ms);
  EXPECT_TRUE(wait_online(1s));
}

TEST_F(TakeoverTest, EmergenciesAreDeliveredBefore) {
  running(bench_settings());
  without_heartbeat();
  start(bench_settings());
  slave_.send(0x085, {0x10, 0x23, 0x01, 0, 0, 0, 0, 0});
  loop_.settle();
  ASSERT_EQ(events_.emergencies.size(), 1U);
  EXPECT_EQ(events_.emergencies[0].code, 0x2310);
  EXPECT_EQ(status().emergencies, 1U);
}

TEST_F(TakeoverTest, AnotherMappingIsLeftAlone) {
  running(bench_settings());
  slave_.set({0x1A00, 2}, DataType::u32, 0x60430010);
  start(bench_settings());
  loop_.advance(30s, 10ms);
  expect_left_alone("0x1A00:02 TPDO1 mapping: expected 0x60440010, found 0x60430010");
  EXPECT_EQ(status().nmt, NmtState::operational);
  send_tpdo(0x27, 1);
  EXPECT_TRUE(events_.tpdos.empty());
}

TEST_F(TakeoverTest, AnotherHeartbeatTimeThatIsInTimeIsARemark) {
  running(bench_settings());
  slave_.set(kHeartbeatTime, DataType::u16, 1000);
  start(bench_settings());
  loop_.advance(3s);
  EXPECT_TRUE(status().online) << status().boot_text;
  ASSERT_EQ(events_.remarks.size(), 1U);
  EXPECT_EQ(events_.remarks[0], "0x1017:00 heartbeat time: expected 500, found 1000, which will do");
  expect_untouched();
}

TEST_F(TakeoverTest, AHeartbeatTimeThatIsTooLongIsLeftAlone) {
  running(bench_settings());
  slave_.set(kHeartbeatTime, DataType::u16, 1500);
  start(bench_settings());
  loop_.advance(3s);
  expect_left_alone("0x1017:00 heartbeat time: expected 500, found 1500");
}

TEST_F(TakeoverTest, AnotherSettingIsLeftAlone) {
  NodeSettings settings = bench_settings();
  settings.setup = {{{0x6007, 0}, DataType::i16, 1}};
  running(settings);
  slave_.set({0x6007, 0}, DataType::i16, 3);
  start(settings);
  loop_.advance(3s);
  expect_left_alone("0x6007:00");
}

TEST_F(TakeoverTest, VerifiedDifferencesAreLeftAloneToo) {
  NodeSettings settings = bench_settings();
  settings.tpdos[0].communication = SetupPolicy::verify;
  running(settings);
  slave_.set({0x1800, 2}, DataType::u8, 254);
  start(settings);
  loop_.advance(3s);
  expect_left_alone("TPDO1 transmission type");
}

TEST_F(TakeoverTest, AnotherIdentityKeepsItsLetter) {
  NodeSettings settings = bench_settings();
  running(settings);
  settings.identity.vendor = 0x91;
  start(settings);
  loop_.advance(3s);
  EXPECT_EQ(status().boot_result, BootResult::other_vendor);
  EXPECT_FALSE(status().online);
  expect_untouched();
}

TEST_F(TakeoverTest, WhatTheDriveLacksIsNoDifference) {
  NodeSettings settings = bench_settings();
  settings.tpdos[0].mapping_policy = SetupPolicy::verify;
  settings.error_control.supervise_gateway = 2s;
  settings.setup = {{{0x6007, 0}, DataType::i16, 1}};
  running(settings);
  for (std::uint8_t sub = 0; sub <= 5; ++sub) {
    slave_.remove({0x1800, sub});
    slave_.remove({0x1A00, sub});
  }
  start(settings);
  loop_.advance(50ms);
  EXPECT_TRUE(status().online) << status().boot_text;
  EXPECT_FALSE(node_->tpdo_verified(1));
  expect_untouched();
}

TEST_F(TakeoverTest, ReconfigureRunningChangesIt) {
  NodeSettings settings = bench_settings();
  settings.reconfigure_running = true;
  running(settings);
  slave_.set({0x1A00, 2}, DataType::u32, 0x60430010);
  start(settings);
  ASSERT_TRUE(wait_online());
  EXPECT_EQ(slave_.value({0x1A00, 2}), 0x60440010U);
  EXPECT_EQ(nmt_heard(), (std::vector<Frame>{nmt(128), nmt(1)}));
  EXPECT_EQ(events_.arrivals, std::vector<Arrival>{Arrival::booted});
}

TEST_F(TakeoverTest, ReconfigureRunningLeavesAFittingDriveAlone) {
  NodeSettings settings = bench_settings();
  settings.reconfigure_running = true;
  running(settings);
  start(settings);
  ASSERT_TRUE(wait_online());
  expect_untouched();
}

TEST_F(TakeoverTest, LeftAloneAlsoAfterItLeavesOperationalByItself) {
  running(bench_settings());
  slave_.set({0x1800, 5}, DataType::u16, 0);
  start(bench_settings());
  loop_.advance(1s);
  expect_left_alone("event timer");
  slave_.set_state(127);
  EXPECT_FALSE(wait_online(30s));
  EXPECT_EQ(status().boot_result, BootResult::not_configured);
  EXPECT_NE(status().boot_text.find("left operational by itself"), std::string::npos) << status().boot_text;
  EXPECT_EQ(slave_.value({0x1800, 5}), 0U);
  expect_untouched();
}

TEST_F(TakeoverTest, LeftAloneUntilItsBootUp) {
  running(bench_settings());
  slave_.set({0x1800, 5}, DataType::u16, 0);
  start(bench_settings());
  loop_.advance(1s);
  expect_left_alone("event timer");
  slave_.boot_up();
  ASSERT_TRUE(wait_online());
  EXPECT_EQ(slave_.value({0x1800, 5}), 100U);
}

TEST_F(TakeoverTest, BootUpDuringInspectionMeansABoot) {
  running(bench_settings());
  slave_.delay_answers(10ms);
  start(bench_settings());
  loop_.advance(50ms);
  EXPECT_GT(slave_.reads().size(), 1U);
  slave_.boot_up();
  ASSERT_TRUE(wait_online());
  EXPECT_EQ(nmt_heard(), std::vector<Frame>{nmt(1)});
  EXPECT_EQ(events_.arrivals, std::vector<Arrival>{Arrival::booted});
}

}  // namespace
}  // namespace canopen
