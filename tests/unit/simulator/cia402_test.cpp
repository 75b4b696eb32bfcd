#include "simulator/cia402.h"

#include <gtest/gtest.h>

#include "tests/unit/simulator/test_bench.h"

namespace simulator {
namespace {

constexpr std::uint8_t kNode = 9;

struct Transition {
  std::vector<std::uint16_t> before;  ///< controlwords from switch on disabled
  std::uint16_t word;
  std::uint16_t status;  ///< masked with 0x6F
};

class StateMachine : public ::testing::TestWithParam<Transition> {};

TEST_P(StateMachine, MakesOneTransition) {
  Cia402 machine;
  for (const std::uint16_t word : GetParam().before) {
    machine.control(word);
  }
  machine.control(GetParam().word);
  EXPECT_EQ(machine.status_bits() & 0x6FU, GetParam().status);
}

INSTANTIATE_TEST_SUITE_P(Transitions, StateMachine,
                         ::testing::Values(Transition{{}, 0x06, 0x21},                        // 2
                                           Transition{{}, 0x0F, 0x40},                        // nothing skips
                                           Transition{{0x06}, 0x07, 0x23},                    // 3
                                           Transition{{0x06}, 0x0F, 0x23},                    // 3 only
                                           Transition{{0x06}, 0x00, 0x40},                    // 7
                                           Transition{{0x06}, 0x02, 0x40},                    // 7
                                           Transition{{0x06, 0x07}, 0x0F, 0x27},              // 4
                                           Transition{{0x06, 0x07}, 0x7F, 0x27},              // 4
                                           Transition{{0x06, 0x07}, 0x06, 0x21},              // 6
                                           Transition{{0x06, 0x07}, 0x00, 0x40},              // 10
                                           Transition{{0x06, 0x07}, 0x02, 0x40},              // 10
                                           Transition{{0x06, 0x07, 0x0F}, 0x07, 0x23},        // 5
                                           Transition{{0x06, 0x07, 0x0F}, 0x06, 0x21},        // 8
                                           Transition{{0x06, 0x07, 0x0F}, 0x00, 0x40},        // 9
                                           Transition{{0x06, 0x07, 0x0F}, 0x02, 0x07},        // 11
                                           Transition{{0x06, 0x07, 0x0F, 0x02}, 0x00, 0x40},  // 12
                                           Transition{{0x06, 0x07, 0x0F, 0x02}, 0x0F, 0x27},  // 16
                                           Transition{{0x06, 0x07, 0x0F, 0x02}, 0x06, 0x07}));

TEST(StateMachineFault, NeedsARisingEdge) {
  Cia402 machine;
  machine.control(0x80);
  machine.trip();
  EXPECT_FALSE(machine.control(0x80));  // it was high already
  EXPECT_EQ(machine.status_bits() & 0x4FU, 0x08U);
  EXPECT_FALSE(machine.control(0x0F));
  EXPECT_TRUE(machine.control(0x8F));
  EXPECT_EQ(machine.state(), Cia402State::switch_on_disabled);
  machine.control(0x0F);
  EXPECT_EQ(machine.state(), Cia402State::switch_on_disabled);
}

class VelocityDrive : public ::testing::Test {
 protected:
  void control(std::uint16_t word) { ASSERT_EQ(bench.write(kNode, 0x6040, 0, word, 2), 0U); }
  void run(std::int16_t rpm) {
    ASSERT_EQ(bench.write(kNode, 0x6042, 0, static_cast<std::uint16_t>(rpm), 2), 0U);
    control(0x06);
    control(0x07);
    control(0x0F);
  }
  std::uint32_t status() { return *bench.read(kNode, 0x6041, 0); }
  std::int16_t rpm() { return static_cast<std::int16_t>(*bench.read(kNode, 0x6044, 0)); }

  OneDrive bench{"cia402-velocity", kNode};
};

TEST_F(VelocityDrive, FollowsTargetRampAndSign) {
  ASSERT_EQ(bench.write(kNode, 0x6048, 1, 600, 4), 0U);
  ASSERT_EQ(bench.write(kNode, 0x6048, 2, 2, 2), 0U);  // 300 rpm/s
  run(900);
  bench.advance(seconds(1));
  EXPECT_NEAR(rpm(), 300, 5);
  EXPECT_EQ(bench.read(kNode, 0x6043, 0), bench.read(kNode, 0x6044, 0));
  EXPECT_EQ(status() & 0x400U, 0U);
  bench.advance(milliseconds(2100));
  EXPECT_EQ(rpm(), 900);
  EXPECT_EQ(status() & 0x46FU, 0x427U);
  ASSERT_EQ(bench.write(kNode, 0x6042, 0, static_cast<std::uint16_t>(-900), 2), 0U);
  bench.advance(seconds(7));
  EXPECT_EQ(rpm(), -900);
  EXPECT_EQ(bench.drive().record().run_commands, 1U);
}

TEST_F(VelocityDrive, HaltStopsAndKeepsTheStateEnabled) {
  run(600);
  bench.advance(seconds(3));
  control(0x10F);
  bench.advance(seconds(3));
  EXPECT_EQ(rpm(), 0);
  EXPECT_EQ(status() & 0x6FU, 0x27U);
  control(0x0F);
  bench.advance(seconds(3));
  EXPECT_EQ(rpm(), 600);
}

TEST_F(VelocityDrive, LeavingOperationStopsAsTheOptionCodesSay) {
  run(1200);
  bench.advance(seconds(5));
  control(0x07);  // 605C = 1: ramp
  EXPECT_EQ(bench.drive().motor().state(), MotorState::stopping);
  bench.advance(seconds(5));
  EXPECT_EQ(bench.drive().motor().state(), MotorState::stopped);
  control(0x0F);
  bench.advance(seconds(5));
  control(0x06);  // 605B = 0: coast
  EXPECT_EQ(bench.drive().motor().state(), MotorState::coasting);
  bench.advance(seconds(10));
  ASSERT_EQ(bench.write(kNode, 0x605B, 0, 1, 2), 0U);
  run(1200);
  bench.advance(seconds(5));
  control(0x06);
  EXPECT_EQ(bench.drive().motor().state(), MotorState::stopping);
  EXPECT_EQ(bench.write(kNode, 0x605B, 0, 2, 2), 0x06090030U);
}

TEST_F(VelocityDrive, QuickStopEndsDisabled) {
  ASSERT_EQ(bench.write(kNode, 0x604A, 1, 1200, 4), 0U);
  run(1200);
  bench.advance(seconds(5));
  control(0x02);
  EXPECT_EQ(status() & 0x6FU, 0x07U);
  bench.advance(milliseconds(500));
  EXPECT_NEAR(rpm(), 600, 15);
  bench.advance(milliseconds(600));
  EXPECT_EQ(status() & 0x4FU, 0x40U);
}

TEST_F(VelocityDrive, AmountsLimitTheTarget) {
  ASSERT_EQ(bench.write(kNode, 0x6046, 2, 700, 4), 0U);
  run(1400);
  bench.advance(seconds(5));
  EXPECT_EQ(rpm(), 700);
  EXPECT_EQ(status() & 0x800U, 0x800U);
  ASSERT_EQ(bench.write(kNode, 0x6042, 0, 600, 2), 0U);
  EXPECT_EQ(status() & 0x800U, 0U);
}

TEST_F(VelocityDrive, FactorsScaleTheTarget) {
  ASSERT_EQ(bench.write(kNode, 0x604C, 1, 60, 4), 0U);
  ASSERT_EQ(bench.write(kNode, 0x604C, 2, 2, 4), 0U);  // 6042 in Hz with two pole pairs
  run(20);
  bench.advance(seconds(5));
  EXPECT_NEAR(bench.drive().motor().output_hz(), 20.0, 1e-9);
  EXPECT_EQ(rpm(), 20);
  EXPECT_EQ(bench.write(kNode, 0x604C, 2, 0, 4), 0x06090030U);
}

TEST_F(VelocityDrive, FaultsAreCiaCodes) {
  run(600);
  bench.advance(seconds(1));
  bench.drive().fault(0x2310);
  bench.loop.settle();
  EXPECT_EQ(bench.take(0x089), std::vector{frame(0x089, {0x10, 0x23, 0x03, 0, 0, 0, 0, 0})});
  EXPECT_EQ(bench.read(kNode, 0x603F, 0), 0x2310U);
  EXPECT_EQ(status() & 0x4FU, 0x08U);
  control(0x0F);
  EXPECT_EQ(status() & 0x4FU, 0x08U);
  control(0x80);
  EXPECT_EQ(status() & 0x4FU, 0x40U);
  EXPECT_EQ(bench.read(kNode, 0x603F, 0), 0U);
  EXPECT_EQ(bench.take(0x089).size(), 1U);
}

TEST_F(VelocityDrive, AbortConnectionOptionDecidesAboutALostHeartbeat) {
  ASSERT_EQ(bench.write(kNode, 0x6007, 0, 2, 2), 0U);
  ASSERT_EQ(bench.write(kNode, 0x1016, 1, 1U << 16U | 100U, 4), 0U);
  bench.send(0x701, {5});
  run(600);
  bench.advance(milliseconds(150));
  EXPECT_EQ(status() & 0x4FU, 0x40U);  // voltage disabled, no fault
  ASSERT_EQ(bench.write(kNode, 0x6007, 0, 0, 2), 0U);
  bench.send(0x701, {5});
  run(600);
  bench.advance(milliseconds(150));
  EXPECT_EQ(status() & 0x6FU, 0x27U);  // goes on
  ASSERT_EQ(bench.write(kNode, 0x6007, 0, 3, 2), 0U);
  bench.send(0x701, {5});
  bench.advance(milliseconds(105));
  EXPECT_EQ(status() & 0x6FU, 0x07U);
}

TEST_F(VelocityDrive, HasTheDefaultPdosOfTheProfile) {
  EXPECT_EQ(bench.read(kNode, 0x1600, 1), 0x60400010U);
  EXPECT_EQ(bench.read(kNode, 0x1601, 2), 0x60600008U);
  EXPECT_EQ(bench.read(kNode, 0x1605, 2), 0x60420010U);
  EXPECT_EQ(bench.read(kNode, 0x1405, 1), 0x80000000U);
  EXPECT_EQ(bench.read(kNode, 0x6502, 0), 2U);
  EXPECT_EQ(bench.read(kNode, 0x6061, 0), 2U);
  bench.start();
  EXPECT_EQ(bench.take(0x189).size(), 1U);
  const auto tpdo2 = bench.take(0x289);
  ASSERT_EQ(tpdo2.size(), 1U);
  EXPECT_EQ(tpdo2[0].size, 3);
  bench.send(0x209, {0x06, 0x00});
  EXPECT_EQ(word_at(*bench.last(0x189), 0) & 0x6FU, 0x21U);  // on change
}

}  // namespace
}  // namespace simulator
