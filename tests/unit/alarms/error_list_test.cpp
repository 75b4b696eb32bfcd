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

// Section "When an error is over" of the manual, for errors that the status word does not show.

TEST_F(AlarmsTest, AnEmergencyLongAfterTheSignalIsAnErrorOfItsOwn) {
  come_online();
  fault(true);
  pass(100ms);
  emcy(0x0004);
  EXPECT_EQ(codes(), (Codes{4})) << "the name of what the signal told";
  build();
  come_online();
  fault(true);
  pass(1h);
  fault(true);
  emcy(0x0004);
  EXPECT_EQ(emcy_alarm().errors.size(), 2U);
  EXPECT_EQ(emcy_alarm().code, 4);
}

TEST_F(AlarmsTest, AWarningWhoseRegisterIsReadBeforeItsSignalComesIsNoFault) {
  come_online();
  readings({.error_register = std::uint8_t{1}, .fault_code = {}, .history = {}});
  EXPECT_TRUE(alarms_->any(Severity::fault)) << "nobody knows better yet";
  pass(10ms);
  fault(false);
  warning(true);
  EXPECT_EQ(emcy_alarm().errors.size(), 1U);
  EXPECT_EQ(emcy_alarm().severity, Severity::warning);
}

TEST_F(AlarmsTest, WhatTurnsOutToBeAWarningIsNotFirst) {
  come_online();
  readings({.error_register = std::uint8_t{1}, .fault_code = {}, .history = {}});
  alarms_->set_first(AlarmKind::emcy, true, wall_);
  EXPECT_TRUE(emcy_alarm().first);
  fault(false);
  warning(true);
  EXPECT_FALSE(emcy_alarm().first);
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
  EXPECT_EQ(emcy_alarm().errors.size(), ErrorList::kMaxErrors);
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

}  // namespace
}  // namespace alarms
