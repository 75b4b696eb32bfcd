// Which errors are active, by emergencies and by the fault and warning bits.

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/unit/alarms/alarms_fixture.h"

namespace alarms {
namespace {

using namespace std::chrono_literals;

TEST_F(AlarmsTest, LowCodesAreTheDrivesOwn) {
  // A CiA 301 decoder would take 0x0004 for "error reset or no error".
  come_online();
  emcy(0x0004, 0x01, {0x04});
  EXPECT_TRUE(emcy_alarm().active);
  EXPECT_EQ(emcy_alarm().code, 0x0004);
  EXPECT_EQ(emcy_alarm().text, "Overcurrent during acceleration");
  EXPECT_EQ(emcy_alarm().severity, Severity::fault);
  EXPECT_EQ(emcy_alarm().error_register, 0x01);
  EXPECT_EQ(emcy_alarm().vendor, (std::array<std::uint8_t, 5>{0x04}));
  EXPECT_TRUE(emcy_alarm().confirmed);
  EXPECT_EQ(emcy_alarm().since, wall_);
  EXPECT_EQ(emcy_alarm().count, 1U);
}

TEST_F(AlarmsTest, ErrorIsOneByCodeAndVendorBytes) {
  come_online();
  emcy(0x0004, 1, {4});
  emcy(0x0004, 1, {4});
  EXPECT_EQ(codes(), (Codes{4}));
  emcy(0x0004, 1, {9});
  EXPECT_EQ(codes(), (Codes{4, 4}));
}

TEST_F(AlarmsTest, RepeatedEmergencyTellsNobody) {
  come_online();
  emcy(0x0004);
  told_.clear();
  pass(1s);
  emcy(0x0004);
  EXPECT_TRUE(told_.empty());
}

TEST_F(AlarmsTest, NewestIsShownButAFaultBeforeAWarning) {
  come_online();
  emcy(0x0040);
  EXPECT_EQ(emcy_alarm().severity, Severity::warning);
  EXPECT_TRUE(alarms_->any(Severity::warning));
  EXPECT_FALSE(alarms_->any(Severity::fault));
  emcy(0x0004);
  EXPECT_EQ(emcy_alarm().code, 0x0004);
  emcy(0x0005);
  EXPECT_EQ(emcy_alarm().code, 0x0005);
  emcy(0x0041);  // Unknown, so a fault.
  EXPECT_EQ(emcy_alarm().code, 0x0041);
  EXPECT_EQ(codes(), (Codes{0x40, 4, 5, 0x41}));
  EXPECT_TRUE(alarms_->any(Severity::warning));
}

TEST_F(AlarmsTest, ResetMakesAllGo) {
  come_online();
  emcy(0x0004);
  emcy(0x0040);
  pass(1s);
  reset();
  EXPECT_FALSE(emcy_alarm().active);
  EXPECT_TRUE(emcy_alarm().errors.empty());
  EXPECT_EQ(emcy_alarm().cleared, wall_);
  EXPECT_FALSE(alarms_->any(Severity::fault));
}

TEST_F(AlarmsTest, ResetWithRemainingErrorsIsNotAllClear) {
  model_.node.emcy = {canopen::EmcyLayout::cia301, true, 0x1000};
  build();
  come_online();
  emcy(0x1000, 0x81, {17});
  emcy(0x8130, 0x91, {1, 127});
  EXPECT_EQ(emcy_alarm().errors[0].text, "drive fault 17");
  reset(0x81, 1);
  EXPECT_EQ(codes(), (Codes{0x1000, 0x8130}));
  EXPECT_EQ(emcy_alarm().error_register, 0x81);
  reset(0x00, 1);
  EXPECT_TRUE(emcy_alarm().active);
  reset(0x00, 0);
  EXPECT_FALSE(emcy_alarm().active);
}

TEST_F(AlarmsTest, ResetWithErrorRegisterIsAPartialOne) {
  // Lenze 8400: 0x0000 with a register that is not 0.
  come_online();
  emcy(0x0004);
  reset(0x08);
  EXPECT_TRUE(emcy_alarm().active);
  EXPECT_EQ(emcy_alarm().error_register, 0x08);
}

TEST_F(AlarmsTest, BitClearsWhatItWasSeenToShow) {
  come_online();
  emcy(0x0004);
  pass(50ms);
  fault(true);
  pass(100ms);
  EXPECT_TRUE(emcy_alarm().active);
  fault(false);
  EXPECT_FALSE(emcy_alarm().active);
}

TEST_F(AlarmsTest, ClearBitAloneTakesThreePeriods) {
  come_online();
  fault(false);
  pass(100ms);
  emcy(0x0004);
  for (int i = 0; i < 3; ++i) {
    pass(100ms);
    fault(false);
    EXPECT_TRUE(emcy_alarm().active) << i;
  }
  pass(100ms);
  fault(false);
  EXPECT_FALSE(emcy_alarm().active);
}

TEST_F(AlarmsTest, ValueSeenSetBeforeTheEmergencyDoesNotCount) {
  come_online();
  emcy(0x0004);
  fault(true);
  pass(100ms);
  emcy(0x0004);  // Again, newer than the bit.
  pass(10ms);
  fault(false);
  EXPECT_TRUE(emcy_alarm().active);
}

TEST_F(AlarmsTest, WarningBitClearsWarningsAndFaultBitFaults) {
  come_online();
  emcy(0x0004);
  emcy(0x0040);
  fault(true);
  warning(true);
  pass(100ms);
  warning(false);
  EXPECT_EQ(codes(), (Codes{4}));
  fault(false);
  EXPECT_FALSE(emcy_alarm().active);
}

TEST_F(AlarmsTest, BitWithoutEmergencyRaisesWithTheFaultCode) {
  come_online();
  alarms_->on_fault_code(5, wall_);
  fault(true);
  EXPECT_TRUE(emcy_alarm().active);
  EXPECT_EQ(emcy_alarm().code, 5);
  EXPECT_EQ(emcy_alarm().text, "Overcurrent during deceleration");
  EXPECT_EQ(emcy_alarm().severity, Severity::fault);
  pass(100ms);
  fault(false);
  EXPECT_FALSE(emcy_alarm().active);
}

TEST_F(AlarmsTest, FaultCodeThatComesLaterNamesTheFault) {
  come_online();
  fault(true);
  EXPECT_EQ(emcy_alarm().code, 0);
  EXPECT_EQ(emcy_alarm().text, "drive reports a fault");
  alarms_->on_fault_code(5, wall_);
  EXPECT_EQ(emcy_alarm().code, 5);
  EXPECT_EQ(emcy_alarm().count, 1U);
  alarms_->on_fault_code(0, wall_);
  EXPECT_EQ(emcy_alarm().code, 5);
}

TEST_F(AlarmsTest, EmergencyAfterTheBitIsTheSameError) {
  come_online();
  fault(true);
  const std::string id = emcy_alarm().id;
  const WallTime since = emcy_alarm().since;
  pass(20ms);
  emcy(0x0004, 1, {4});
  EXPECT_EQ(codes(), (Codes{4}));
  EXPECT_EQ(emcy_alarm().id, id);
  EXPECT_EQ(emcy_alarm().errors[0].since, since);
}

TEST_F(AlarmsTest, WarningBitIsNotNamedByTheCodeOfAFault) {
  come_online();
  alarms_->on_fault_code(4, wall_);
  fault(true);
  warning(true);
  ASSERT_EQ(emcy_alarm().errors.size(), 2U);
  EXPECT_EQ(emcy_alarm().errors[1].text, "drive reports a warning");
  EXPECT_EQ(emcy_alarm().errors[1].severity, Severity::warning);
}

TEST_F(AlarmsTest, BitStillSetAfterAResetIsNoNewAlarmForThreePeriods) {
  come_online();
  emcy(0x0004);
  fault(true);
  reset();
  pass(50ms);
  fault(true);  // Sampled before the reset.
  EXPECT_FALSE(emcy_alarm().active);
  pass(100ms);
  fault(false);
  EXPECT_FALSE(emcy_alarm().active);
  EXPECT_EQ(emcy_alarm().count, 1U);
}

TEST_F(AlarmsTest, BitThatStaysSetAfterAResetIsAnAlarm) {
  come_online();
  emcy(0x0004);
  fault(true);
  reset();
  for (int i = 0; i < 2; ++i) {
    pass(100ms);
    fault(true);
    EXPECT_FALSE(emcy_alarm().active);
  }
  pass(100ms);
  fault(true);
  EXPECT_TRUE(emcy_alarm().active);
  EXPECT_EQ(emcy_alarm().count, 2U);
}

TEST_F(AlarmsTest, BitThatComesAgainAfterAResetIsAnAlarmAtOnce) {
  come_online();
  emcy(0x0004);
  fault(true);
  reset();
  fault(false);
  pass(10ms);
  fault(true);
  EXPECT_TRUE(emcy_alarm().active);
}

TEST_F(AlarmsTest, ChangingVendorBytesDoNotFillTheMemory) {
  come_online();
  emcy(0x0004, 1, {1});
  emcy(0x0040);
  for (int i = 0; i < 10000; ++i) {
    emcy(0x0005, 1, {static_cast<std::uint8_t>(i), static_cast<std::uint8_t>(i >> 8)});
  }
  EXPECT_EQ(emcy_alarm().errors.size(), Emergencies::kMaxErrors);
  EXPECT_EQ(emcy_alarm().code, 0x0005);
  reset();
  EXPECT_FALSE(emcy_alarm().active);
}

TEST_F(AlarmsTest, WarningsMakeRoomBeforeFaults) {
  come_online();
  emcy(0x0004);
  for (int i = 0; i < 100; ++i) {
    emcy(0x0040, 1, {static_cast<std::uint8_t>(i)});
  }
  EXPECT_EQ(emcy_alarm().code, 0x0004);
}

// The makers' manuals do not say which code is a fault: the table's severity is a guess, the drive's bits are not.
TEST_F(AlarmsTest, TheBitsDecideWhetherAnEmergencyIsAFault) {
  come_online();
  fault(false);
  warning(false);
  emcy(0x0004);
  EXPECT_EQ(emcy_alarm().severity, Severity::fault);
  pass(100ms);
  fault(false);
  warning(true);
  EXPECT_EQ(codes(), (Codes{4}));
  EXPECT_EQ(emcy_alarm().severity, Severity::warning);
  EXPECT_EQ(emcy_alarm().text, "Overcurrent during acceleration");
  for (int i = 0; i < 5; ++i) {
    pass(100ms);
    fault(false);
    warning(true);
  }
  EXPECT_EQ(codes(), (Codes{4})) << "as long as its bit is set";
  warning(false);
  EXPECT_FALSE(emcy_alarm().active);
}

TEST_F(AlarmsTest, AFaultWhoseBitComesAfterTheWarningBitKeepsItsName) {
  come_online();
  emcy(0x0004);
  fault(false);
  warning(true);
  const std::string id = emcy_alarm().id;
  pass(100ms);
  fault(true);
  warning(false);
  EXPECT_EQ(codes(), (Codes{4}));
  EXPECT_EQ(emcy_alarm().severity, Severity::fault);
  EXPECT_EQ(emcy_alarm().id, id);
}

TEST_F(AlarmsTest, AWarningBitAloneIsNamedByTheFaultCode) {
  come_online();
  alarms_->on_fault_code(0x0005, wall_);
  fault(false);
  warning(true);
  EXPECT_EQ(codes(), (Codes{5}));
  EXPECT_EQ(emcy_alarm().severity, Severity::warning);
}

}  // namespace
}  // namespace alarms
