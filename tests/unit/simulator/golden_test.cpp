// The manuals' own example frames against the simulated drives.
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/unit/simulator/golden_trace.h"
#include "tests/unit/simulator/test_bench.h"

namespace simulator {
namespace {

/// Sends the trace's request and expects its answer, byte for byte.
void expect_exchange(Bench& bench, std::string_view name) {
  SCOPED_TRACE(std::string(name));
  const auto trace = golden_trace(name);
  ASSERT_EQ(trace.size(), 2U);
  bench.take(trace[1].frame.id);
  bench.send(trace[0].frame);
  const auto answers = bench.take(trace[1].frame.id);
  ASSERT_EQ(answers.size(), 1U);
  EXPECT_EQ(answers[0], trace[1].frame);
}

TEST(Golden, EveryTraceIsReadable) {
  const auto names = golden_trace_names();
  EXPECT_EQ(names.size(), 19U);
  for (const std::string& name : names) {
    EXPECT_NO_THROW(static_cast<void>(golden_trace(name))) << name;
  }
}

class VeichiExamples : public ::testing::TestWithParam<const char*> {};

TEST_P(VeichiExamples, SdoExchangesAreThoseOfTheManual) {
  OneDrive bench(GetParam(), 2);
  expect_exchange(bench, "veichi-sdo-read-f02-02");
  expect_exchange(bench, "veichi-sdo-write-f02-02");
  EXPECT_EQ(bench.read(2, 0x2002, 3), 3U);
  expect_exchange(bench, "veichi-sdo-read-c00-26-short");
  expect_exchange(bench, "veichi-sdo-read-3006-short");
  expect_exchange(bench, "veichi-sdo-write-3006-short");
  EXPECT_EQ(bench.read(2, 0x2030, 7), 100U);
}

TEST_P(VeichiExamples, NmtCommandsLeadToTheStatesOfTheManual) {
  DriveOptions options;
  options.heartbeat_ms = 100;
  OneDrive bench(GetParam(), 2, options);
  const auto commands = golden_trace("veichi-nmt-commands");
  const auto states = golden_trace("veichi-heartbeat-states");  // stopped, operational, pre-operational
  ASSERT_EQ(commands.size(), 5U);
  const auto state_after = [&](std::size_t command) {
    bench.send(commands[command].frame);
    bench.take(0x702);
    bench.advance(milliseconds(100));
    return bench.last(0x702);
  };
  EXPECT_EQ(state_after(0), states[1].frame);
  EXPECT_EQ(state_after(1), states[0].frame);
  EXPECT_EQ(state_after(2), states[2].frame);
  bench.send(commands[0].frame);
  EXPECT_EQ(state_after(3), states[2].frame);  // reset node
  bench.send(commands[0].frame);
  EXPECT_EQ(state_after(4), states[2].frame);  // reset communication
  EXPECT_EQ(bench.drive().record().nmt_command_count, 7U);
}

INSTANTIATE_TEST_SUITE_P(Series, VeichiExamples, ::testing::Values("veichi-ac300", "veichi-ac310"));

TEST(GoodriveExamples, BootUpAndHeartbeat) {
  Bench bench;
  const auto drive = make_drive("invt-goodrive600", 3, bench.network);
  drive->power_on();
  bench.loop.settle();
  EXPECT_EQ(bench.take(0x703), std::vector{golden_trace("goodrive600-boot-up")[0].frame});

  ASSERT_EQ(bench.write(3, 0x1017, 0, 100, 2), 0U);
  bench.nmt(0x01, 3);
  for (const TraceFrame& expected : golden_trace("goodrive600-heartbeat")) {
    bench.advance(milliseconds(99));
    EXPECT_TRUE(bench.take(0x703).empty());
    bench.advance(milliseconds(1));
    EXPECT_EQ(bench.take(0x703), std::vector{expected.frame});
  }
  bench.send(golden_trace("goodrive600-heartbeat-disable")[0].frame);
  EXPECT_EQ(bench.take(0x583), std::vector{frame(0x583, {0x60, 0x17, 0x10, 0, 0, 0, 0, 0})});
  bench.advance(seconds(2));
  EXPECT_TRUE(bench.take(0x703).empty());
}

TEST(GoodriveExamples, SdoAnswersSixteenBitsAsFourBytes) {
  OneDrive bench("invt-goodrive600", 3);
  expect_exchange(bench, "goodrive600-sdo-read-1801-03");
}

TEST(GoodriveExamples, EmergencyComesAndGoes) {
  OneDrive bench("invt-goodrive600", 3);
  const auto trace = golden_trace("goodrive600-emcy-out1");
  bench.drive().fault(1);
  bench.loop.settle();
  EXPECT_EQ(bench.take(0x083), std::vector{trace[0].frame});
  bench.drive().clear_faults();
  bench.loop.settle();
  EXPECT_EQ(bench.take(0x083), std::vector{trace[1].frame});
}

TEST(GoodriveExamples, FiftyHertzAsSettingTwo) {
  DriveOptions options;
  options.goodrive_settings = {0, 1};
  OneDrive bench("invt-goodrive600", 3, options);
  bench.start();
  bench.send(golden_trace("goodrive600-rpdo2-50hz")[0].frame);
  EXPECT_EQ(bench.drive().record().rpdos[1], 1U);
  bench.advance(seconds(6));
  EXPECT_DOUBLE_EQ(bench.drive().motor().output_hz(), 50.0);
}

TEST(GoodriveExamples, ParameterChannelSetsAReturn) {
  DriveOptions options;
  options.goodrive_returns = {};
  OneDrive bench("invt-goodrive600", 3, options);
  bench.start();
  EXPECT_EQ(bench.read(3, 0x2000, 3), 0U);
  expect_exchange(bench, "goodrive600-parameter-channel");
  ASSERT_EQ(bench.write(3, 0x2100, 3, 2000, 2), 0U);
  ASSERT_EQ(bench.write(3, 0x2101, 0, 1, 2), 0U);
  bench.advance(seconds(3));
  EXPECT_EQ(bench.read(3, 0x2000, 3), 2000U);  // return 1 is the running frequency now
}

TEST(GoodriveExamples, SyncWithoutDataIsHeard) {
  OneDrive bench("invt-goodrive600", 3);
  bench.send(golden_trace("goodrive600-sync")[0].frame);
  EXPECT_EQ(bench.drive().record().syncs, 1U);
  EXPECT_EQ(bench.drive().record().sync_length_errors, 0U);
}

TEST(Opte6Examples, ResetCommunicationLeadsToABootUp) {
  OneDrive bench("vacon-opte6", 4);
  bench.start();
  expect_exchange(bench, "opte6-reset-communication");
  EXPECT_EQ(bench.drive().state(), NmtState::pre_operational);
}

TEST(Opte6Examples, HeartbeatStates) {
  DriveOptions options;
  options.heartbeat_ms = 100;
  OneDrive bench("vacon-opte6", 4, options);
  const auto states = golden_trace("opte6-heartbeat-states");  // boot-up, stopped, operational, pre-operational
  bench.nmt(0x81, 4);
  EXPECT_EQ(bench.take(0x704), std::vector{states[0].frame});
  bench.advance(milliseconds(100));
  EXPECT_EQ(bench.take(0x704), std::vector{states[3].frame});
  bench.nmt(0x02, 0);
  bench.advance(milliseconds(100));
  EXPECT_EQ(bench.take(0x704), std::vector{states[1].frame});
  bench.nmt(0x01, 0);
  bench.advance(milliseconds(100));
  EXPECT_EQ(bench.take(0x704), std::vector{states[2].frame});
}

}  // namespace
}  // namespace simulator
