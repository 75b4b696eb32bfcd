// Errors over loss and return of a drive, and over a restart of the gateway.

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/unit/alarms/alarms_fixture.h"

namespace alarms {
namespace {

using namespace std::chrono_literals;

TEST_F(AlarmsTest, OfflineKeepsTheAlarmUnconfirmed) {
  come_online();
  emcy(0x0004);
  const Alarm before = emcy_alarm();
  go_offline();
  EXPECT_TRUE(emcy_alarm().active);
  EXPECT_FALSE(emcy_alarm().confirmed);
  EXPECT_EQ(emcy_alarm().id, before.id);
  EXPECT_EQ(emcy_alarm().errors, before.errors);
}

TEST_F(AlarmsTest, AfterReturnTheErrorRegisterDecides) {
  come_online();
  emcy(0x0004);
  go_offline();
  come_online();
  EXPECT_FALSE(emcy_alarm().confirmed);
  readings({.error_register = std::uint8_t{0x01}, .fault_code = 4, .history = {}});
  EXPECT_TRUE(emcy_alarm().confirmed);
  EXPECT_EQ(codes(), (Codes{4}));
  go_offline();
  come_online();
  readings({.error_register = std::uint8_t{0}, .fault_code = {}, .history = {}});
  EXPECT_FALSE(emcy_alarm().active);
  EXPECT_TRUE(emcy_alarm().confirmed);
}

TEST_F(AlarmsTest, AbsentErrorRegisterDecidesNothing) {
  come_online();
  emcy(0x0004);
  go_offline();
  come_online();
  readings({.register_absent = true});
  EXPECT_TRUE(emcy_alarm().active);
  EXPECT_FALSE(emcy_alarm().confirmed);
  fault(true);
  EXPECT_TRUE(emcy_alarm().confirmed);
  fault(false);
  EXPECT_FALSE(emcy_alarm().active);
}

TEST_F(AlarmsTest, ThatItIsNotConfirmedIsNoChangeOfTheAlarm) {
  come_online();
  emcy(0x0004);
  const WallTime changed = emcy_alarm().ts;
  pass(std::chrono::seconds(5));
  go_offline();
  EXPECT_FALSE(emcy_alarm().confirmed);
  EXPECT_EQ(emcy_alarm().ts, changed) << "it stays as it was";
  pass(std::chrono::seconds(5));
  come_online();
  EXPECT_EQ(emcy_alarm().ts, changed);
  emcy(0x0005);
  EXPECT_EQ(emcy_alarm().ts, wall_);
}

TEST_F(AlarmsTest, WithoutAnyWitnessTheAlarmStaysUnconfirmedUntilAnEmergency) {
  come_online();
  emcy(0x0004);
  go_offline();
  come_online();
  readings({.register_absent = true});
  pass(24h);
  EXPECT_TRUE(emcy_alarm().active);
  EXPECT_FALSE(emcy_alarm().confirmed);
  reset();
  EXPECT_FALSE(emcy_alarm().active);
}

TEST_F(AlarmsTest, FaultBitSurvivesAnErrorRegisterThatIsAlwaysZero) {
  come_online();
  fault(true);
  readings({.error_register = std::uint8_t{0}, .fault_code = {}, .history = {}});
  EXPECT_TRUE(emcy_alarm().active);
  EXPECT_EQ(emcy_alarm().count, 1U);
}

TEST_F(AlarmsTest, RestoredAlarmGoesOnUnconfirmedUnderItsId) {
  Alarm before;
  before.active = true;
  before.id = "pump1-emcy-1";
  before.code = 4;
  before.text = "Overcurrent during acceleration";
  before.vendor = {4};
  before.since = WallTime(5s);
  before.count = 3;
  before.errors = {{4, {4}, "Overcurrent during acceleration", Severity::fault, WallTime(5s)}};
  alarms_->restore(AlarmKind::emcy, before);
  EXPECT_EQ(told_, std::vector<AlarmKind>{AlarmKind::emcy});
  EXPECT_TRUE(emcy_alarm().active);
  EXPECT_FALSE(emcy_alarm().confirmed);
  EXPECT_EQ(emcy_alarm().id, "pump1-emcy-1");
  EXPECT_EQ(emcy_alarm().count, 3U);
  EXPECT_EQ(emcy_alarm().since, WallTime(5s));

  come_online();
  EXPECT_FALSE(emcy_alarm().confirmed);
  fault(true);
  EXPECT_TRUE(emcy_alarm().confirmed);
  EXPECT_EQ(codes(), (Codes{4}));
  EXPECT_EQ(emcy_alarm().count, 3U);
  emcy(0x0004, 1, {4});
  EXPECT_EQ(codes(), (Codes{4}));
}

TEST_F(AlarmsTest, RestoredAlarmThatIsOverGoesAtArrival) {
  Alarm before;
  before.active = true;
  before.id = "old";
  before.code = 4;
  before.count = 1;
  before.errors = {{4, {4}, "Overcurrent during acceleration", Severity::fault, WallTime(5s)}};
  alarms_->restore(AlarmKind::emcy, before);
  EXPECT_EQ(codes(), (Codes{4}));
  come_online();
  for (int i = 0; i < 4; ++i) {
    fault(false);
    pass(100ms);
  }
  EXPECT_TRUE(undecided());
  reads(0x00);
  EXPECT_FALSE(emcy_alarm().active);
  EXPECT_EQ(emcy_alarm().id, "old");
  emcy(0x0005);
  EXPECT_NE(emcy_alarm().id, "old");
  EXPECT_EQ(emcy_alarm().count, 2U);
}

TEST_F(AlarmsTest, RestoredErrorByVendorNumberIsNotDoubled) {
  model_.node.emcy.layout = canopen::EmcyLayout::class_and_vendor40;
  model_.faults.drive_texts = {{1, {"OUt1", Severity::fault}}};
  build();
  Alarm before;
  before.active = true;
  before.errors = {{0x3000, {1}, "OUt1", Severity::fault, WallTime(5s)}};
  alarms_->restore(AlarmKind::emcy, before);
  come_online();
  readings({.error_register = std::uint8_t{0x04}, .fault_code = 1, .history = {}});
  EXPECT_EQ(codes(), (Codes{0x3000}));
}

Alarm restored_overcurrent() {
  Alarm before;
  before.active = true;
  before.id = "old";
  before.errors = {
      {4, {}, "Overcurrent during acceleration", config::Severity::fault, canopen::WallTime(std::chrono::seconds(5))}};
  return before;
}

TEST_F(AlarmsTest, ARestoredFaultThatTheFaultCodeNamesIsTheSame) {
  alarms_->restore(AlarmKind::emcy, restored_overcurrent());
  come_online();
  fault(true);
  alarms_->on_fault_code(0x04, wall_);
  fault(true);
  EXPECT_EQ(codes(), (Codes{4}));
  EXPECT_EQ(emcy_alarm().id, "old");
}

TEST_F(AlarmsTest, AnotherFaultThanTheRestoredOneIsNamed) {
  alarms_->restore(AlarmKind::emcy, restored_overcurrent());
  come_online();
  alarms_->on_fault_code(0x40, wall_);
  fault(true);
  EXPECT_EQ(codes(), (Codes{4})) << "this code is of a warning";
  warning(false);
  fault(true);
  EXPECT_EQ(codes(), (Codes{4, 0x40})) << "but the drive has none, whatever the table says";
}

TEST_F(AlarmsTest, AnotherFaultThanTheRestoredOneIsNamedByItsNumber) {
  alarms_->restore(AlarmKind::emcy, restored_overcurrent());
  come_online();
  alarms_->on_fault_code(0x05, wall_);
  fault(true);
  EXPECT_EQ(codes(), (Codes{4, 5}));
  EXPECT_EQ(emcy_alarm().id, "old");
}

TEST_F(AlarmsTest, RestoredWarningsStayWarnings) {
  Alarm before;
  before.active = true;
  before.code = 0x71;
  before.text = "b";
  before.severity = Severity::warning;
  before.errors = {{0x70, {}, "a", Severity::warning, WallTime(5s)}, {0x71, {}, "b", Severity::warning, WallTime(6s)}};
  alarms_->restore(AlarmKind::emcy, before);
  EXPECT_EQ(emcy_alarm().code, 0x71);
  EXPECT_EQ(emcy_alarm().severity, Severity::warning);
  EXPECT_FALSE(alarms_->any(Severity::fault));
}

TEST_F(AlarmsTest, ARestoredWarningBesideAFaultIsOfTheWarningBit) {
  Alarm before;
  before.active = true;
  before.code = 4;
  before.text = "Overcurrent during acceleration";
  before.errors = {{0x40, {}, "Undervoltage while stopped", Severity::warning, WallTime(5s)},
                   {4, {}, before.text, Severity::fault, WallTime(6s)}};
  build_without_following_register();
  alarms_->restore(AlarmKind::emcy, before);
  come_online();
  for (int i = 0; i < 4; ++i) {
    fault(false);
    warning(true);
    pass(100ms);
  }
  EXPECT_EQ(codes(), (Codes{0x40}));
  EXPECT_EQ(emcy_alarm().severity, Severity::warning);
  EXPECT_EQ(emcy_alarm().errors[0].since, WallTime(5s));
}

TEST_F(AlarmsTest, BeforeTheFirstArrivalNothingIsConfirmed) {
  EXPECT_FALSE(emcy_alarm().active);
  EXPECT_FALSE(emcy_alarm().confirmed);
  come_online();
  EXPECT_FALSE(emcy_alarm().confirmed) << "nor before it was asked";
  readings({.error_register = std::uint8_t{0}, .fault_code = {}, .history = {}});
  EXPECT_FALSE(emcy_alarm().active);
  EXPECT_TRUE(emcy_alarm().confirmed);
}

}  // namespace
}  // namespace alarms
