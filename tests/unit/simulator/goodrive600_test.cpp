#include <gtest/gtest.h>

#include "tests/unit/simulator/test_bench.h"

namespace simulator {
namespace {

constexpr std::uint8_t kHoist = 3;

class Goodrive : public ::testing::Test {
 protected:
  /// RPDO2: control word, settings 1..3; setting 1 is the frequency by default.
  void command(std::uint8_t code, std::uint16_t frequency, std::uint8_t high = 0) {
    bench.send(0x303, {code, high, static_cast<std::uint8_t>(frequency), static_cast<std::uint8_t>(frequency >> 8U), 0,
                       0, 0, 0});
  }
  double hertz() { return bench.drive().motor().output_hz(); }
  std::uint32_t status() { return *bench.read(kHoist, 0x2001, 0); }

  OneDrive bench{"invt-goodrive600", kHoist};
};

TEST_F(Goodrive, ShowsNoIdentity) {
  EXPECT_EQ(bench.read(kHoist, 0x1000, 0), 0U);
  EXPECT_EQ(bench.read(kHoist, 0x1018, 0), 4U);
  EXPECT_EQ(bench.read(kHoist, 0x1018, 1), 0U);
  EXPECT_EQ(bench.read(kHoist, 0x1018, 4), 0U);
  EXPECT_EQ(bench.read_abort(kHoist, 0x1008, 0), 0x06020000U);
  EXPECT_EQ(bench.read_abort(kHoist, 0x1016, 0), 0x06020000U);
}

TEST_F(Goodrive, ControlWordIsACode) {
  bench.start();
  EXPECT_EQ(status(), 0x4103U);  // stopped, bus voltage, by communication
  command(1, 2000);
  bench.advance(seconds(3));
  EXPECT_DOUBLE_EQ(hertz(), 20.0);
  EXPECT_EQ(status(), 0x4101U);
  command(2, 2000);
  bench.advance(seconds(5));
  EXPECT_DOUBLE_EQ(hertz(), -20.0);
  EXPECT_EQ(status(), 0x4102U);
  command(5, 2000);
  bench.advance(seconds(1));
  EXPECT_NEAR(hertz(), -10.0, 0.2);
  command(6, 2000);
  EXPECT_EQ(hertz(), 0.0);
  EXPECT_EQ(status(), 0x4103U);
  bench.advance(seconds(5));
  command(3, 2000);
  bench.advance(seconds(2));
  EXPECT_DOUBLE_EQ(hertz(), 5.0);  // jogging
  command(8, 2000);
  bench.advance(seconds(2));
  EXPECT_EQ(hertz(), 0.0);
  command(1, 2000, 0x80);
  bench.advance(seconds(1));
  EXPECT_EQ(hertz(), 0.0);  // anything in the high byte: no code
}

TEST_F(Goodrive, ReturnsAreWhatTheDriveWasToldToSend) {
  bench.start();
  command(1, 2500);
  bench.advance(seconds(4));
  const auto tpdo2 = bench.last(0x283);
  ASSERT_TRUE(tpdo2.has_value());
  EXPECT_EQ(tpdo2->size, 8);
  EXPECT_EQ(word_at(*tpdo2, 0), 0x4101U);
  EXPECT_EQ(word_at(*tpdo2, 2), 2500U);
  EXPECT_EQ(word_at(*tpdo2, 4), 2500U);
  EXPECT_NEAR(word_at(*tpdo2, 6), 3070, 50);
  EXPECT_EQ(bench.read(kHoist, 0x2000, 5), word_at(*tpdo2, 6));
  EXPECT_EQ(bench.read(kHoist, 0x2000, 6), 0U);  // return 4 is not assigned
}

TEST_F(Goodrive, EveryReturnCanBeChosen) {
  const auto choose = [&](std::uint8_t meaning) {
    bench.send(0x203, {2, 0, 0x0D, 0x0F, meaning, 0});
    return *bench.read(kHoist, 0x2000, 3);
  };
  bench.start();
  bench.drive().fault(1);
  EXPECT_EQ(choose(11), 1U);
  bench.drive().clear_faults();
  EXPECT_EQ(choose(3), 3111U);
  EXPECT_EQ(choose(12), 0U);
  EXPECT_EQ(choose(0), 0U);
  DriveOptions options;
  options.goodrive_returns = {4, 5, 6, 7, 8, 10, 1, 2};
  OneDrive other("invt-goodrive600", kHoist, options);
  ASSERT_EQ(other.write(kHoist, 0x2100, 3, 2500, 2), 0U);
  ASSERT_EQ(other.write(kHoist, 0x2101, 0, 2, 2), 0U);
  other.advance(seconds(4));
  EXPECT_EQ(other.read(kHoist, 0x2000, 3), 110U);     // V
  EXPECT_GT(*other.read(kHoist, 0x2000, 4), 30U);     // 0.1 A
  EXPECT_EQ(other.read(kHoist, 0x2000, 5), 0xFF38U);  // -20.0 % = -(5 + 60/4)
  EXPECT_EQ(other.read(kHoist, 0x2000, 6), 100U);     // 0.1 %
  EXPECT_EQ(other.read(kHoist, 0x2000, 7), 750U);     // rpm
  EXPECT_EQ(other.read(kHoist, 0x2000, 8), 2500U);
  EXPECT_EQ(other.read(kHoist, 0x2000, 9), 2500U);
  EXPECT_EQ(other.read(kHoist, 0x2000, 10), 2500U);
}

TEST_F(Goodrive, AFaultIsResetByCodeSeven) {
  bench.start();
  command(1, 2000);
  bench.advance(seconds(1));
  bench.drive().fault(1);
  EXPECT_EQ(status() & 0xFFU, 4U);
  EXPECT_EQ(hertz(), 0.0);
  command(1, 2000);
  bench.advance(seconds(1));
  EXPECT_EQ(hertz(), 0.0);
  command(7, 2000);
  EXPECT_EQ(status() & 0xFFU, 3U);
  bench.drive().warning(9);
  EXPECT_EQ(status() & 0x1000U, 0x1000U);
}

TEST_F(Goodrive, OtherFaultsAreGenericWithTheirNumber) {
  bench.drive().fault(0x1234);
  bench.loop.settle();
  EXPECT_EQ(bench.take(0x083), std::vector{frame(0x083, {0x00, 0x10, 0x01, 0x34, 0x12, 0, 0, 0})});
}

TEST_F(Goodrive, AnRpdo1OfAWrongLengthIsAnError) {
  bench.start();
  bench.send(0x203, {2, 0, 0x0D, 0x0F, 1, 0, 0, 0});
  EXPECT_EQ(bench.take(0x083), std::vector{frame(0x083, {0x10, 0x82, 0x11, 0, 0, 0, 0, 0})});
  EXPECT_TRUE(bench.take(0x183).empty());
  EXPECT_EQ(bench.drive().record().rpdo_length_errors, 1U);
  bench.send(0x203, {1, 0, 0x0D, 0x0F, 0, 0});
  EXPECT_EQ(bench.take(0x083), std::vector{frame(0x083, {0, 0, 0, 0, 0, 0, 0, 0})});
  EXPECT_EQ(bench.take(0x183).size(), 1U);
}

TEST_F(Goodrive, TheParameterChannelRefusesWithItsCodes) {
  bench.start();
  const auto ask = [&](std::uint8_t request, std::uint8_t number, std::uint8_t group) {
    bench.advance(milliseconds(50));  // the shortest inhibit time
    bench.send(0x203, {request, 0, number, group, 5, 0});
    return bench.last(0x183);
  };
  EXPECT_EQ(ask(4, 0x0D, 0x0F), frame(0x183, {3, 0, 1, 0, 0, 0, 0, 0}));
  EXPECT_EQ(ask(1, 0x0D, 0x63), frame(0x183, {3, 0, 2, 0, 0, 0, 0, 0}));
  EXPECT_EQ(ask(1, 0x0E, 0x0F), frame(0x183, {1, 0, 0, 0, 2, 0, 0, 0}));  // return 2: set frequency
  command(1, 2000);
  bench.advance(seconds(1));
  EXPECT_EQ(ask(2, 0x0D, 0x0F), frame(0x183, {3, 0, 8, 0, 0, 0, 0, 0}));
  EXPECT_EQ(ask(0, 0, 0), frame(0x183, {0, 0, 0, 0, 0, 0, 0, 0}));
}

TEST_F(Goodrive, TpdoOneKnowsOnlyItsOwnType) {
  EXPECT_EQ(bench.write(kHoist, 0x1800, 2, 254, 1), 0x06090030U);
  EXPECT_EQ(bench.write(kHoist, 0x1800, 5, 100, 2), 0x06090030U);
  EXPECT_EQ(bench.write(kHoist, 0x1801, 2, 0, 1), 0x06090030U);
  EXPECT_EQ(bench.write(kHoist, 0x1801, 2, 252, 1), 0x06090030U);
  EXPECT_EQ(bench.write(kHoist, 0x1A01, 1, 0x20000310, 4), 0x06010002U);
  EXPECT_EQ(bench.read(kHoist, 0x1A01, 1), 0x20010010U);
}

TEST_F(Goodrive, TypeTwoFiveFourIsPeriodicOrOnChange) {
  ASSERT_EQ(bench.write(kHoist, 0x1801, 3, 0, 2), 0U);
  bench.start();
  EXPECT_EQ(bench.take(0x283).size(), 1U);
  bench.advance(seconds(1));
  EXPECT_TRUE(bench.take(0x283).empty());
  command(1, 500);
  bench.advance(milliseconds(500));
  // Ramping changes it every tick; 50 ms are the least between two.
  const auto count = bench.take(0x283).size();
  EXPECT_GE(count, 9U);
  EXPECT_LE(count, 11U);
  ASSERT_EQ(bench.write(kHoist, 0x1801, 5, 200, 2), 0U);
  bench.take(0x283);
  bench.advance(seconds(2));
  EXPECT_EQ(bench.take(0x283).size(), 10U);
}

TEST_F(Goodrive, TypeTwoFiveFiveAnswersItsRpdo) {
  ASSERT_EQ(bench.write(kHoist, 0x1801, 2, 255, 1), 0U);
  ASSERT_EQ(bench.write(kHoist, 0x1801, 3, 0, 2), 0U);
  bench.start();
  bench.advance(seconds(1));
  EXPECT_TRUE(bench.take(0x283).empty());
  command(0, 0);
  EXPECT_EQ(bench.take(0x283).size(), 1U);
  command(0, 0);
  EXPECT_TRUE(bench.take(0x283).empty());  // within 50 ms
  bench.advance(milliseconds(50));
  EXPECT_EQ(bench.take(0x283).size(), 1U);
}

TEST_F(Goodrive, SynchronousTypesCountSyncs) {
  ASSERT_EQ(bench.write(kHoist, 0x1802, 2, 3, 1), 0U);
  bench.start();
  bench.take(0x383);
  for (int i = 1; i <= 9; ++i) {
    bench.send(0x80, {});
    EXPECT_EQ(bench.take(0x383).size(), i % 3 == 0 ? 1U : 0U) << i;
  }
  bench.send(0x80, {1});  // this card knows no counter
  EXPECT_EQ(bench.drive().record().sync_length_errors, 1U);
}

TEST_F(Goodrive, CommunicationSettingsAreLostWithoutPower) {
  ASSERT_EQ(bench.write(kHoist, 0x1801, 5, 200, 2), 0U);
  ASSERT_EQ(bench.write(kHoist, 0x1801, 1, 0x80000283U, 4), 0U);
  bench.drive().reboot();
  bench.advance(seconds(1));
  EXPECT_EQ(bench.read(kHoist, 0x1801, 5), 0U);
  EXPECT_EQ(bench.read(kHoist, 0x1801, 1), 0x283U);
  EXPECT_EQ(bench.read(kHoist, 0x1801, 3), 1000U);
}

}  // namespace
}  // namespace simulator
