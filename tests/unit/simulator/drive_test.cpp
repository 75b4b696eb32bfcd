// What all kinds have in common: power, NMT, making drives.
#include "simulator/drive.h"

#include <gtest/gtest.h>

#include "tests/unit/simulator/test_bench.h"

namespace simulator {
namespace {

class EveryKind : public ::testing::TestWithParam<const char*> {};

TEST_P(EveryKind, BootsIntoPreOperational) {
  Bench bench;
  const auto drive = make_drive(GetParam(), 11, bench.network);
  ASSERT_NE(drive, nullptr);
  EXPECT_EQ(drive->kind(), GetParam());
  EXPECT_FALSE(drive->powered());
  EXPECT_EQ(bench.read_abort(11, 0x1000, 0), 1U);  // silence without power
  drive->power_on();
  bench.loop.settle();
  EXPECT_EQ(bench.take(0x70B), std::vector{frame(0x70B, {0})});
  EXPECT_EQ(drive->state(), NmtState::pre_operational);
  EXPECT_TRUE(bench.read(11, 0x1000, 0).has_value());
  EXPECT_EQ(bench.read_abort(11, 0x1234, 0), 0x06020000U);
}

TEST_P(EveryKind, ObeysNmtForItselfAndForAll) {
  OneDrive bench(GetParam(), 11);
  bench.nmt(0x01, 12);
  EXPECT_EQ(bench.drive().state(), NmtState::pre_operational);
  bench.nmt(0x01, 11);
  EXPECT_EQ(bench.drive().state(), NmtState::operational);
  bench.nmt(0x02, 0);
  EXPECT_EQ(bench.drive().state(), NmtState::stopped);
  EXPECT_EQ(bench.read_abort(11, 0x1000, 0), 1U);  // no SDO in stopped
  bench.nmt(0x80, 0);
  EXPECT_EQ(bench.drive().state(), NmtState::pre_operational);
  bench.nmt(0x33, 11);
  EXPECT_EQ(bench.drive().state(), NmtState::pre_operational);
  bench.send(0, {0x01});
  bench.send(0, {0x01, 11, 0});
  EXPECT_EQ(bench.drive().state(), NmtState::pre_operational);
  ASSERT_EQ(bench.drive().record().nmt_commands.size(), 4U);
  EXPECT_EQ(bench.drive().record().nmt_commands[1].command, 0x02);
  EXPECT_EQ(bench.drive().record().nmt_commands[1].node, 0);
}

TEST_P(EveryKind, ResetsAreFollowedByABootUp) {
  OneDrive bench(GetParam(), 11);
  for (const std::uint8_t command : {std::uint8_t{0x81}, std::uint8_t{0x82}}) {
    bench.start();
    bench.heard.clear();
    bench.nmt(command, 11);
    EXPECT_EQ(bench.take(0x70B), std::vector{frame(0x70B, {0})});
    EXPECT_EQ(bench.drive().state(), NmtState::pre_operational);
  }
}

TEST_P(EveryKind, HeartbeatTimeIsLostOnPowerCycle) {
  OneDrive bench(GetParam(), 11);
  EXPECT_EQ(bench.read(11, 0x1017, 0), 0U);
  ASSERT_EQ(bench.write(11, 0x1017, 0, 200, 2), 0U);
  bench.advance(milliseconds(1000));
  EXPECT_EQ(bench.take(0x70B).size(), 5U);
  bench.drive().reboot(milliseconds(300));
  bench.advance(milliseconds(299));
  EXPECT_FALSE(bench.drive().powered());
  EXPECT_TRUE(bench.take(0x70B).empty());
  bench.advance(milliseconds(1));
  EXPECT_EQ(bench.take(0x70B).size(), 1U);
  bench.advance(milliseconds(1000));
  EXPECT_TRUE(bench.take(0x70B).empty());
  EXPECT_EQ(bench.read(11, 0x1017, 0), 0U);
}

TEST_P(EveryKind, PowerCycleStopsTheMotorForGood) {
  OneDrive bench(GetParam(), 11);
  bench.drive().motor().set_target(20);
  bench.drive().motor().run(false);
  bench.advance(seconds(1));
  EXPECT_GT(bench.drive().motor().output_hz(), 5.0);
  bench.drive().reboot(milliseconds(100));
  EXPECT_EQ(bench.drive().motor().output_hz(), 0.0);
  bench.advance(seconds(2));
  bench.start();
  bench.advance(seconds(2));
  EXPECT_EQ(bench.drive().motor().state(), MotorState::stopped);
  EXPECT_EQ(bench.drive().motor().output_hz(), 0.0);
}

TEST_P(EveryKind, AFaultTripsIsReportedOnceAndClears) {
  OneDrive bench(GetParam(), 11);
  bench.drive().motor().set_target(20);
  bench.drive().motor().run(false);
  bench.advance(seconds(1));
  bench.drive().fault(0x0005);
  bench.drive().fault(0x0005);
  bench.loop.settle();
  EXPECT_EQ(bench.drive().motor().output_hz(), 0.0);
  EXPECT_EQ(bench.take(0x08B).size(), 1U);
  EXPECT_NE(bench.read(11, 0x1001, 0), 0U);
  bench.drive().clear_faults();
  bench.loop.settle();
  EXPECT_EQ(bench.take(0x08B), std::vector{frame(0x08B, {0, 0, 0, 0, 0, 0, 0, 0})});
  EXPECT_EQ(bench.read(11, 0x1001, 0), 0U);
  bench.advance(seconds(1));
  EXPECT_EQ(bench.drive().motor().output_hz(), 0.0);  // a reset does not start it again
}

TEST_P(EveryKind, SaysNothingOfAFaultInStopped) {
  OneDrive bench(GetParam(), 11);
  bench.nmt(0x02, 11);
  bench.drive().fault(0x0005);
  bench.loop.settle();
  EXPECT_TRUE(bench.take(0x08B).empty());
  EXPECT_EQ(bench.drive().model().fault(), 0x0005);
}

TEST_P(EveryKind, GoesToAnotherStateOfItsOwnAccord) {
  DriveOptions options;
  options.heartbeat_ms = 100;
  OneDrive bench(GetParam(), 11, options);
  bench.start();
  bench.drive().go(NmtState::pre_operational);
  bench.advance(milliseconds(100));
  EXPECT_EQ(bench.take(0x70B), std::vector{frame(0x70B, {0x7F})});
  EXPECT_EQ(bench.drive().record().nmt_commands.size(), 1U);
  bench.drive().go(NmtState::off);
  EXPECT_TRUE(bench.drive().powered());
}

TEST_P(EveryKind, TakesItsTimeToBoot) {
  Bench bench;
  DriveOptions options;
  options.boot_time = milliseconds(800);
  const auto drive = make_drive(GetParam(), 11, bench.network, options);
  drive->power_on();
  bench.advance(milliseconds(799));
  EXPECT_TRUE(bench.heard.empty());
  EXPECT_EQ(drive->state(), NmtState::initialising);
  bench.nmt(0x01, 11);
  EXPECT_EQ(drive->state(), NmtState::initialising);
  bench.advance(milliseconds(1));
  EXPECT_EQ(bench.take(0x70B).size(), 1U);
  drive->power_off();
  bench.advance(seconds(5));
  EXPECT_TRUE(bench.heard.empty());
}

TEST_P(EveryKind, PowerOnDuringARebootDoesNotBootTwice) {
  OneDrive bench(GetParam(), 11);
  bench.drive().reboot(milliseconds(500));
  bench.drive().power_on();
  bench.advance(seconds(2));
  EXPECT_EQ(bench.take(0x70B).size(), 1U);
}

TEST_P(EveryKind, SurvivesEveryFrame) {
  OneDrive bench(GetParam(), 11);
  bench.start();
  std::uint32_t random = 1;
  const auto next = [&random] { return random = random * 1664525U + 1013904223U; };
  for (int i = 0; i < 20000; ++i) {
    canopen::Frame hostile;
    const std::uint32_t choice = next() >> 28U;
    hostile.id = choice < 10 ? 0x600U + 11 : next() >> 21U;
    hostile.size = static_cast<std::uint8_t>((next() >> 24U) % 9);
    hostile.remote = (next() >> 24U) % 16 == 0;
    for (auto& byte : hostile.data) {
      byte = static_cast<std::uint8_t>(next() >> 24U);
    }
    if (choice < 8) {
      constexpr std::array<std::uint16_t, 8> kIndexes{0x1000, 0x1003, 0x1016, 0x1400, 0x1600, 0x1A00, 0x2000, 0x6040};
      const auto index = static_cast<std::uint16_t>(kIndexes[(next() >> 24U) % 8] + (next() >> 24U) % 32);
      hostile.data[1] = static_cast<std::uint8_t>(index);
      hostile.data[2] = static_cast<std::uint8_t>(index >> 8U);
      hostile.data[3] %= 8;
    }
    bench.queue(hostile);
    if (i % 100 == 0) {
      bench.loop.advance(milliseconds(10), milliseconds(10));
      bench.heard.clear();
    }
  }
  bench.nmt(0x81, 0);
  bench.advance(seconds(1));
  EXPECT_TRUE(bench.read(11, 0x1000, 0).has_value());
}

INSTANTIATE_TEST_SUITE_P(Kinds, EveryKind,
                         ::testing::Values("veichi-ac300", "veichi-ac310", "invt-goodrive600", "vacon-opte6",
                                           "cia402-velocity"));

TEST(MakeDrive, UnknownKindsAndNodesAreExplained) {
  Bench bench;
  EXPECT_EQ(make_drive("abb", 3, bench.network), nullptr);
  EXPECT_EQ(why_no_drive("abb", 3),
            "unknown kind of drive \"abb\"; known are veichi-ac300, veichi-ac310, invt-goodrive600, vacon-opte6, "
            "cia402-velocity");
  EXPECT_EQ(make_drive("veichi-ac300", 0, bench.network), nullptr);
  EXPECT_EQ(make_drive("veichi-ac300", 128, bench.network), nullptr);
  EXPECT_EQ(why_no_drive("veichi-ac300", 128), "node 128 is not possible; nodes are 1 to 127");
  EXPECT_EQ(why_no_drive("veichi-ac300", 127), "");
}

}  // namespace
}  // namespace simulator
