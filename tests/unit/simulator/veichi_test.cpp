#include <gtest/gtest.h>

#include "tests/unit/simulator/test_bench.h"

namespace simulator {
namespace {

constexpr std::uint8_t kPump = 5;

class VeichiTest : public ::testing::TestWithParam<const char*> {
 protected:
  /// RPDO1: command, frequency in 0.01 Hz, torque.
  static void command(Bench& bench, std::uint16_t code, std::uint16_t frequency) {
    bench.send(0x200U + kPump,
               {static_cast<std::uint8_t>(code), static_cast<std::uint8_t>(code >> 8U),
                static_cast<std::uint8_t>(frequency), static_cast<std::uint8_t>(frequency >> 8U), 0, 0});
  }
};

TEST_P(VeichiTest, SendsThreePdosEveryHundredMilliseconds) {
  OneDrive bench(GetParam(), kPump);
  bench.advance(seconds(1));
  EXPECT_TRUE(bench.heard.empty());  // not in pre-operational
  bench.start();
  bench.heard.clear();
  for (int i = 0; i < 20; ++i) {
    bench.advance(milliseconds(100));
    ASSERT_EQ(bench.take(0x185).size(), 1U) << i;
    ASSERT_EQ(bench.take(0x285).size(), 1U) << i;
    ASSERT_EQ(bench.take(0x385).size(), 1U) << i;
    ASSERT_TRUE(bench.heard.empty());  // TPDO4 has no default mapping
  }
}

TEST_P(VeichiTest, PdosHoldTheVariablesOfTheManualsTable) {
  OneDrive bench(GetParam(), kPump);
  bench.start();
  command(bench, 1, 3000);
  bench.advance(seconds(4));
  command(bench, 1, 3000);
  bench.advance(seconds(1));
  const auto tpdo1 = bench.last(0x185);
  const auto tpdo2 = bench.last(0x285);
  const auto tpdo3 = bench.last(0x385);
  ASSERT_TRUE(tpdo1 && tpdo2 && tpdo3);
  EXPECT_EQ(tpdo1->size, 8);
  EXPECT_EQ(word_at(*tpdo1, 0) & 0xBFFFU, 0x0081U);  // running, ready, neither ramp, forward
  EXPECT_EQ(word_at(*tpdo1, 2), bench.read(kPump, 0x2021, 3));
  EXPECT_GT(word_at(*tpdo1, 2), 30U);
  EXPECT_EQ(word_at(*tpdo1, 4), 3000U);
  EXPECT_EQ(word_at(*tpdo1, 6), 900U);
  EXPECT_EQ(tpdo2->size, 6);
  EXPECT_EQ(word_at(*tpdo2, 0), bench.read(kPump, 0x2021, 0x0B));
  EXPECT_EQ(word_at(*tpdo2, 2), 2200U);
  EXPECT_EQ(word_at(*tpdo2, 4), 0U);
  EXPECT_EQ(tpdo3->size, 8);
  EXPECT_EQ(word_at(*tpdo3, 0), 266U);  // 5 % + 60 % * 0.36
  EXPECT_EQ(word_at(*tpdo3, 2), bench.read(kPump, 0x2021, 0x0C));
  EXPECT_EQ(word_at(*tpdo3, 4), 1320U);
  EXPECT_GT(word_at(*tpdo3, 6), 300U);
}

TEST_P(VeichiTest, StatusBitsFollowTheMotor) {
  OneDrive bench(GetParam(), kPump);
  bench.start();
  const auto status = [&] { return *bench.read(kPump, 0x2030, 3) & 0xBFFFU; };
  EXPECT_EQ(status(), 0x0080U);
  command(bench, 2, 1000);
  bench.advance(milliseconds(500));
  EXPECT_EQ(status(), 0x008BU);  // running, accelerating, reverse
  bench.advance(seconds(2));
  EXPECT_EQ(status(), 0x0089U);
  EXPECT_EQ(bench.read(kPump, 0x2021, 8).value() & 0x8000U, 0x8000U);  // negative torque
  command(bench, 5, 1000);
  bench.advance(milliseconds(500));
  EXPECT_EQ(status(), 0x008DU);  // decelerating
  bench.advance(seconds(2));
  EXPECT_EQ(status() & 0x0087U, 0x0080U);
  bench.drive().warning(0x0084);
  EXPECT_EQ(status() & 0x0050U, 0x0040U);
  bench.drive().fault(0x0005);
  EXPECT_EQ(status() & 0x00D0U, 0x0050U);
  EXPECT_EQ(bench.read(kPump, 0x2030, 4), 0x0005U);
}

TEST_P(VeichiTest, TheLifeBitToggles) {
  OneDrive bench(GetParam(), kPump);
  const auto life = [&] { return *bench.read(kPump, 0x2030, 3) & 0x4000U; };
  const auto first = life();
  bench.advance(milliseconds(500));
  EXPECT_NE(life(), first);
  bench.advance(milliseconds(500));
  EXPECT_EQ(life(), first);
}

TEST_P(VeichiTest, EmergencyHoldsTheDrivesOwnCode) {
  OneDrive bench(GetParam(), kPump);
  bench.drive().fault(0x012A);
  bench.loop.settle();
  EXPECT_EQ(bench.take(0x085), std::vector{frame(0x085, {0x2A, 0x01, 0x01, 0x2A, 0x01, 0, 0, 0})});
  bench.drive().warning(0x0084);
  bench.loop.settle();
  EXPECT_TRUE(bench.take(0x085).empty());
}

TEST_P(VeichiTest, AFaultedDriveDoesNotRunAndIsResetByItsCommand) {
  OneDrive bench(GetParam(), kPump);
  bench.start();
  bench.drive().fault(4);
  command(bench, 1, 2000);
  bench.advance(seconds(1));
  EXPECT_EQ(bench.drive().motor().output_hz(), 0.0);
  EXPECT_EQ(bench.drive().record().run_commands, 0U);
  command(bench, 7, 2000);
  EXPECT_EQ(bench.read(kPump, 0x2030, 4), 0U);
  EXPECT_EQ(bench.take(0x085).back(), frame(0x085, {0, 0, 0, 0, 0, 0, 0, 0}));
  bench.advance(seconds(1));
  EXPECT_EQ(bench.drive().motor().output_hz(), 0.0);
  command(bench, 1, 2000);
  bench.advance(seconds(1));
  EXPECT_GT(bench.drive().motor().output_hz(), 5.0);
}

TEST_P(VeichiTest, RpdosAreDeafOutsideOperational) {
  OneDrive bench(GetParam(), kPump);
  command(bench, 1, 2000);
  bench.nmt(0x02, kPump);
  command(bench, 1, 2000);
  bench.advance(seconds(1));
  EXPECT_EQ(bench.drive().motor().output_hz(), 0.0);
  EXPECT_EQ(bench.drive().record().rpdo_total(), 0U);
}

TEST_P(VeichiTest, RunsBySdoInPreOperational) {
  OneDrive bench(GetParam(), kPump);
  ASSERT_EQ(bench.write(kPump, 0x2030, 1, 1500, 2), 0U);
  bench.advance(seconds(1));
  EXPECT_EQ(bench.drive().motor().output_hz(), 0.0);
  ASSERT_EQ(bench.write(kPump, 0x2030, 2, 1, 2), 0U);
  bench.advance(seconds(3));
  EXPECT_DOUBLE_EQ(bench.drive().motor().output_hz(), 15.0);
  ASSERT_EQ(bench.write(kPump, 0x2030, 5, 1000, 2), 0U);  // upper frequency limit
  bench.advance(seconds(3));
  EXPECT_DOUBLE_EQ(bench.drive().motor().output_hz(), 10.0);
  ASSERT_EQ(bench.write(kPump, 0x2030, 2, 6, 2), 0U);
  EXPECT_EQ(bench.drive().motor().state(), MotorState::coasting);
  EXPECT_EQ(bench.write(kPump, 0x2030, 2, 8, 2), 0x06090030U);
  EXPECT_EQ(bench.write(kPump, 0x2030, 1, 5001, 2), 0x06090030U);
}

TEST_P(VeichiTest, WithoutBusControlCommandsHaveNoEffect) {
  DriveOptions options;
  options.veichi_bus_control = false;
  OneDrive bench(GetParam(), kPump, options);
  bench.start();
  command(bench, 1, 2000);
  bench.advance(seconds(1));
  EXPECT_EQ(bench.drive().motor().output_hz(), 0.0);
  const bool ac300 = GetParam() == std::string("veichi-ac300");
  ASSERT_EQ(ac300 ? bench.write(kPump, 0x2000, 3, 2, 2) : bench.write(kPump, 0x2001, 2, 3, 2), 0U);
  ASSERT_EQ(ac300 ? bench.write(kPump, 0x2000, 4, 6, 2) : bench.write(kPump, 0x2001, 3, 10, 2), 0U);
  command(bench, 1, 2000);
  bench.advance(seconds(3));
  EXPECT_DOUBLE_EQ(bench.drive().motor().output_hz(), 20.0);
}

TEST_P(VeichiTest, OnlyTheEepromIndexesWearAndLast) {
  OneDrive bench(GetParam(), kPump);
  ASSERT_EQ(bench.write(kPump, 0x2003, 2, 11, 2), 0U);
  ASSERT_EQ(bench.write(kPump, 0x2014, 2, 12, 2), 0U);
  EXPECT_EQ(bench.drive().record().eeprom_writes, 0U);
  ASSERT_EQ(bench.write(kPump, 0x20F4, 2, 13, 2), 0U);  // F04.01
  ASSERT_EQ(bench.write(kPump, 0x20A5, 2, 14, 2), 0U);  // F21.01
  EXPECT_EQ(bench.drive().record().eeprom_writes, 2U);
  EXPECT_EQ(bench.read(kPump, 0x2004, 2), 13U);
  EXPECT_EQ(bench.read(kPump, 0x2015, 2), 14U);
  bench.drive().power_off();
  bench.drive().power_on();
  EXPECT_EQ(bench.read(kPump, 0x2003, 2), 0U);
  EXPECT_EQ(bench.read(kPump, 0x2014, 2), 0U);
  EXPECT_EQ(bench.read(kPump, 0x2004, 2), 13U);
  EXPECT_EQ(bench.read(kPump, 0x2015, 2), 14U);
}

TEST_P(VeichiTest, AnswersAreWordedAsInTheManualsExamples) {
  OneDrive bench(GetParam(), kPump);
  EXPECT_EQ(bench.sdo(kPump, {0x2B, 0x1F, 0x20, 0x01, 7, 0, 0, 0}), frame(0x585, {0x4B, 0x1F, 0x20, 0x01, 7, 0, 0, 0}));
  EXPECT_EQ(bench.sdo(kPump, {0x2B, 0xF0, 0x20, 0x01, 7, 0, 0, 0}), frame(0x585, {0x60, 0xF0, 0x20, 0x01, 0, 0, 0, 0}));
  EXPECT_EQ(bench.sdo(kPump, {0x2B, 0x30, 0x20, 0x01, 0, 0, 0, 0}), frame(0x585, {0x60, 0x30, 0x20, 0x01}));
  EXPECT_EQ(bench.sdo(kPump, {0x40, 0x21, 0x20, 0x04, 0, 0, 0, 0}), frame(0x585, {0x4B, 0x21, 0x20, 0x04, 0x98, 0x08}));
}

TEST_P(VeichiTest, AbortsAreThoseOfTheManual) {
  OneDrive bench(GetParam(), kPump);
  EXPECT_EQ(bench.read_abort(kPump, 0x2000, 0), 0x06090011U);
  EXPECT_EQ(bench.read_abort(kPump, 0x2100, 1), 0x06020000U);  // C groups start at 0x2021
  EXPECT_EQ(bench.read_abort(kPump, 0x2020, 1), 0x06020000U);
  EXPECT_EQ(bench.read_abort(kPump, 0x2021, 0x0A), 0x06090011U);
  EXPECT_EQ(bench.write(kPump, 0x2021, 2, 1, 2), 0x06010002U);
  EXPECT_EQ(bench.write(kPump, 0x2030, 3, 1, 2), 0x06010002U);
  EXPECT_EQ(bench.read_abort(kPump, 0x2030, 2), 0x08000000U);  // write only; the card's list has no code for that
  EXPECT_EQ(bench.write(kPump, 0x2002, 3, 1, 1), 0x06070010U);
  EXPECT_EQ(bench.sdo(kPump, {0x21, 0x02, 0x20, 0x03, 2, 0, 0, 0})->data[4], 0x01);  // segmented: unknown command
}

TEST_P(VeichiTest, HasNoPdoObjectsUnlessAskedTo) {
  OneDrive bench(GetParam(), kPump);
  for (const int index : {0x1400, 0x1600, 0x1800, 0x1A00}) {
    EXPECT_EQ(bench.read_abort(kPump, static_cast<std::uint16_t>(index), 0), 0x06020000U);
  }
}

TEST_P(VeichiTest, PdoObjectsFollowTheManualsRules) {
  DriveOptions options;
  options.veichi_pdo_objects = true;
  OneDrive bench(GetParam(), kPump, options);
  EXPECT_EQ(bench.read(kPump, 0x1400, 1), 0x205U);
  EXPECT_EQ(bench.read(kPump, 0x1A00, 0), 4U);
  EXPECT_EQ(bench.read(kPump, 0x1A00, 1), 0x20300310U);
  EXPECT_EQ(bench.write(kPump, 0x1800, 2, 252, 1), 0x06090030U);
  EXPECT_EQ(bench.write(kPump, 0x1800, 2, 253, 1), 0x06090030U);
  EXPECT_EQ(bench.write(kPump, 0x1600, 1, 0x20300310, 4), 0x06040041U);  // not writable
  EXPECT_EQ(bench.write(kPump, 0x1A00, 1, 0x20300210, 4), 0x06040041U);
  EXPECT_EQ(bench.write(kPump, 0x1A00, 1, 0x20210220, 4), 0x06040041U);  // 16 bits, not 32
  ASSERT_EQ(bench.write(kPump, 0x1A03, 1, 0x20211B10, 4), 0U);
  ASSERT_EQ(bench.write(kPump, 0x1A03, 0, 1, 1), 0U);
  EXPECT_EQ(bench.write(kPump, 0x1A03, 0, 9, 1), 0x06040042U);
  ASSERT_EQ(bench.write(kPump, 0x1A00, 1, 0x20210210, 4), 0U);
  EXPECT_EQ(bench.write(kPump, 0x1A00, 0, 1, 1), 0x08000000U);  // the status word is mandatory
  bench.start();
  bench.advance(milliseconds(100));
  EXPECT_EQ(bench.last(0x485), frame(0x485, {220, 0}));
}

INSTANTIATE_TEST_SUITE_P(Series, VeichiTest, ::testing::Values("veichi-ac300", "veichi-ac310"));

TEST(VeichiSeriesTest, KeepTheirNodeInDifferentParameters) {
  OneDrive ac300("veichi-ac300", kPump);
  EXPECT_EQ(ac300.read(kPump, 0x200D, 0x0D), 5U);
  EXPECT_EQ(ac300.read(kPump, 0x200D, 0x03), 30U);
  OneDrive ac310("veichi-ac310", kPump);
  EXPECT_EQ(ac310.read(kPump, 0x200C, 0x2A), 5U);
  EXPECT_EQ(ac310.read(kPump, 0x200C, 0x2B), 3U);
}

}  // namespace
}  // namespace simulator
