// A node in service: values, loss and return, NMT commands, SDO and RPDO commands.

#include "canopen/node/remote_node.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "tests/unit/canopen/node_bench.h"

namespace canopen {
namespace {

using namespace std::chrono_literals;

class RemoteNodeTest : public NodeCommandBench {};

TEST_F(RemoteNodeTest, OnlineWithinTwoSeconds) {
  install(bench_settings());
  start(bench_settings());
  slave_.boot_up();
  EXPECT_TRUE(wait_online(2s));
}

TEST_F(RemoteNodeTest, ValuesComeInMappingOrder) {
  bring_online(bench_settings());
  send_tpdo(0x1237, 0xFFFE);
  ASSERT_EQ(events_.tpdos.size(), 1U);
  EXPECT_EQ(events_.tpdos[0].first, 1U);
  EXPECT_EQ(events_.tpdos[0].second, (std::vector<Raw>{0x1237, static_cast<Raw>(-2)}));
}

TEST_F(RemoteNodeTest, FirstTpdoAfterTheStartProvesOperationalAndCounts) {
  install(bench_settings());
  slave_.heartbeat_off(false);
  start(bench_settings());
  slave_.boot_up();
  ASSERT_TRUE(loop_.advance_until([this] { return !nmt_heard().empty(); }, 2s));
  send_tpdo(0x21, 7);
  EXPECT_TRUE(status().online);
  ASSERT_EQ(events_.tpdos.size(), 1U);
  EXPECT_EQ(events_.tpdos[0].second, (std::vector<Raw>{0x21, 7}));
  // A heartbeat that was waiting in the drive behind the TPDO is no sign that it left operational again.
  slave_.send(0x705, {0x7F});
  loop_.settle();
  EXPECT_EQ(status().boot_result, BootResult::ok);
  loop_.advance(3s);
  EXPECT_TRUE(status().online);
  EXPECT_EQ(status().nmt, NmtState::operational);
}

TEST_F(RemoteNodeTest, OfALongerTpdoTheFirstBytesCountAndAShorterOneIsNotDecoded) {
  bring_online(bench_settings());
  slave_.send(0x185, {1, 2, 3});
  slave_.send(0x185, {1, 2, 3, 4, 5, 6});
  loop_.settle();
  ASSERT_EQ(events_.tpdos.size(), 1U);
  EXPECT_EQ(events_.tpdos[0].second, (std::vector<Raw>{0x0201, 0x0403}));
  EXPECT_EQ(events_.wrong_lengths, (std::vector<std::pair<std::uint16_t, std::size_t>>{{1, 3}, {1, 6}}));
}

TEST_F(RemoteNodeTest, StatusIsToldOnlyWhenItChanges) {
  bring_online(bench_settings());
  const std::size_t told = events_.statuses.size();
  loop_.advance(10s, 10ms);
  EXPECT_EQ(events_.statuses.size(), told);
  EXPECT_LE(Clock::now() - *status().last_heartbeat, 500ms);
}

TEST_F(RemoteNodeTest, LossAndReturnOperational) {
  bring_online(bench_settings());
  const auto reading = support::spawn(loop_.executor(), node_->read(kControlWord, DataType::u16));
  slave_.unplug(true);
  const auto late = support::spawn(loop_.executor(), node_->read(kControlWord, DataType::u16));
  loop_.advance(2001ms);
  EXPECT_TRUE(status().lost);
  EXPECT_FALSE(status().online);
  EXPECT_EQ(status().nmt, NmtState::unknown);
  EXPECT_EQ(status().heartbeat_losses, 1U);
  ASSERT_TRUE(reading.done() && late.done());
  slave_.unplug(false);
  slave_.forget_heard();
  ASSERT_TRUE(wait_online());
  EXPECT_FALSE(status().lost);
  EXPECT_EQ(events_.arrivals.back(), Arrival::taken_over);
  EXPECT_TRUE(slave_.writes().empty());
  EXPECT_TRUE(nmt_heard().empty());
}

TEST_F(RemoteNodeTest, LossFailsWhatIsPending) {
  NodeSettings settings = bench_settings();
  settings.sdo.timeout = 5s;
  bring_online(settings);
  slave_.unplug(true);
  const auto reading = support::spawn(loop_.executor(), node_->read(kControlWord, DataType::u16));
  const auto writing = write(6, 5s);
  loop_.advance(2001ms);
  ASSERT_TRUE(reading.done() && writing.done());
  EXPECT_EQ(reading.get().error().kind, ErrorKind::offline);
  EXPECT_EQ(writing.get().error().kind, ErrorKind::offline);
  expect_write_refused();
}

TEST_F(RemoteNodeTest, ReturnNotOperationalIsBootedAndStarted) {
  bring_online(bench_settings());
  lose();
  slave_.set_state(127);  // It may have rebooted unseen.
  slave_.set({0x1800, 5}, DataType::u16, 0);
  slave_.unplug(false);
  ASSERT_TRUE(wait_online());
  EXPECT_EQ(events_.arrivals.back(), Arrival::booted);
  EXPECT_EQ(slave_.value({0x1800, 5}), 100U);
  EXPECT_EQ(nmt_heard(), std::vector<Frame>{nmt(1)});
}

TEST_F(RemoteNodeTest, TpdosAloneDoNotBringALostDriveBack) {
  bring_online(bench_settings());
  slave_.heartbeat_off(true);
  for (int i = 0; i < 80; ++i) {
    loop_.advance(100ms);
    send_tpdo(0x27, 1);
  }
  EXPECT_FALSE(status().online);
  EXPECT_TRUE(status().lost);
  EXPECT_EQ(status().boot_result, BootResult::no_error_control) << status().boot_text;
  EXPECT_EQ(status().heartbeat_losses, 1U);
  EXPECT_EQ(events_.arrivals.size(), 1U);
  slave_.heartbeat_off(false);
  loop_.advance(6s);
  EXPECT_TRUE(status().online);
  EXPECT_EQ(events_.arrivals.back(), Arrival::taken_over);
  EXPECT_TRUE(nmt_heard().empty());
}

TEST_F(RemoteNodeTest, BootUpInServiceMeansAFullBoot) {
  bring_online(bench_settings());
  ASSERT_TRUE(rpdo_now({control(6), target(0)}).has_value());
  slave_.forget_heard();
  slave_.boot_up();
  loop_.settle();
  EXPECT_FALSE(status().online);
  EXPECT_EQ(events_.boot_ups, 2);
  ASSERT_TRUE(wait_online());
  EXPECT_EQ(nmt_heard(), std::vector<Frame>{nmt(1)});
  EXPECT_TRUE(slave_.heard_on(0x205).empty()) << "RPDOs stay silent";
}

TEST_F(RemoteNodeTest, LeavingOperationalByItselfIsToldAndNotCorrected) {
  bring_online(bench_settings());
  slave_.set_state(127);
  loop_.advance(1s);
  EXPECT_TRUE(status().online);
  EXPECT_EQ(status().nmt, NmtState::pre_operational);
  EXPECT_EQ(status().boot_result, BootResult::not_configured);
  EXPECT_NE(status().boot_text.find("left operational by itself"), std::string::npos);
  loop_.advance(60s, 10ms);
  EXPECT_TRUE(nmt_heard().empty());
  EXPECT_TRUE(slave_.writes().empty());
  expect_write_refused();
}

TEST_F(RemoteNodeTest, StartCommandEndsTheRefusalWithABoot) {
  bring_online(bench_settings());
  slave_.set_state(127);
  slave_.set({0x1800, 5}, DataType::u16, 0);  // It rebooted unseen.
  loop_.advance(1s);
  const auto started = command(NmtCommand::start);
  ASSERT_TRUE(loop_.advance_until([&] { return started.done(); }, 2s));
  EXPECT_TRUE(started.get().has_value());
  EXPECT_EQ(slave_.value({0x1800, 5}), 100U);
  ASSERT_TRUE(wait_online());
  EXPECT_EQ(status().boot_result, BootResult::ok);
  EXPECT_EQ(status().nmt, NmtState::operational);
  EXPECT_EQ(nmt_heard(), std::vector<Frame>{nmt(1)});
}

TEST_F(RemoteNodeTest, ALossEndsTheRefusalForItMayHaveRebooted) {
  bring_online(bench_settings());
  slave_.set_state(127);
  loop_.advance(1s);
  ASSERT_EQ(status().boot_result, BootResult::not_configured);
  lose();
  slave_.set({0x1800, 5}, DataType::u16, 0);
  slave_.unplug(false);
  ASSERT_TRUE(wait_online());
  EXPECT_EQ(slave_.value({0x1800, 5}), 100U);
  EXPECT_EQ(nmt_heard(), std::vector<Frame>{nmt(1)});
  EXPECT_EQ(status().boot_result, BootResult::ok);
}

TEST_F(RemoteNodeTest, StartedBySomebodyElseItIsInspectedAgain) {
  bring_online(bench_settings());
  slave_.set_state(127);
  loop_.advance(1s);
  slave_.forget_heard();
  slave_.set_state(5);
  loop_.advance(1s);
  EXPECT_TRUE(status().online);
  EXPECT_EQ(status().boot_result, BootResult::ok);
  EXPECT_EQ(events_.arrivals.back(), Arrival::taken_over);
  EXPECT_FALSE(slave_.reads().empty());
  EXPECT_TRUE(nmt_heard().empty());
}

TEST_F(RemoteNodeTest, EndFailsWhatIsPending) {
  bring_online(bench_settings());
  slave_.mute_sdo(true);
  const auto reading = support::spawn(loop_.executor(), node_->read(kControlWord, DataType::u16));
  const auto writing = write(6);
  loop_.advance(10ms);
  const auto stopped = support::spawn(loop_.executor(), node_->stop());
  loop_.settle();
  ASSERT_TRUE(*stopped);
  ASSERT_TRUE(reading.done() && writing.done());
  EXPECT_EQ(reading.get().error().kind, ErrorKind::offline);
  EXPECT_EQ(writing.get().error().kind, ErrorKind::offline);
}

}  // namespace
}  // namespace canopen
