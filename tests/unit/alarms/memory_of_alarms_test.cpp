// What an alarm is after the gateway's start, with and without memory of it, until it is decided.

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/unit/alarms/alarms_fixture.h"

namespace alarms {
namespace {

using namespace std::chrono_literals;

class MemoryOfAlarmsTest : public AlarmsTest {
 protected:
  static Alarm active(const std::string& text) {
    Alarm before;
    before.active = true;
    before.known = true;
    before.id = "old";
    before.text = text;
    before.since = WallTime(5s);
    before.ts = WallTime(6s);
    before.count = 7;
    before.first = true;
    before.errors = {{0, {}, text, Severity::fault, WallTime(5s)}};
    return before;
  }
  static Alarm over() {
    Alarm before = active("was");
    before.active = false;
    before.cleared = WallTime(8s);
    before.errors.clear();
    return before;
  }

  [[nodiscard]] const Alarm& alarm(AlarmKind kind) const { return alarms_->alarm(kind); }
  void expect_goes_on(AlarmKind kind) {
    EXPECT_TRUE(alarm(kind).active);
    EXPECT_EQ(alarm(kind).id, "old");
    EXPECT_EQ(alarm(kind).since, WallTime(5s));
    EXPECT_EQ(alarm(kind).count, 7U);
    EXPECT_EQ(alarm(kind).first, alarm(kind).severity == Severity::fault);
    EXPECT_TRUE(alarm(kind).confirmed);
  }
  void expect_ended(AlarmKind kind) {
    EXPECT_FALSE(alarm(kind).active);
    EXPECT_EQ(alarm(kind).id, "old");
    EXPECT_EQ(alarm(kind).cleared, wall_);
    EXPECT_EQ(alarm(kind).count, 7U);
  }
  void expect_as_it_was(AlarmKind kind, Alarm before) {
    before.confirmed = false;
    EXPECT_EQ(alarm(kind), before) << name_of(kind);
  }
  void find_missing() { go_offline(true); }
  void find_not_bootable() {
    status_.boot_result = canopen::BootResult::not_configured;
    status_.boot_text = "refused";
    alarms_->on_status(status_, wall_);
  }
  /// A boot-up message, and nothing more yet.
  void boot_up() {
    ++status_.boot_ups;
    alarms_->on_status(status_, wall_);
  }
  void settle() { alarms_->on_settled(wall_); }
};

TEST_F(MemoryOfAlarmsTest, WithoutMemoryNothingIsKnownAtFirst) {
  for (const AlarmKind kind : kAlarmKinds) {
    EXPECT_FALSE(alarm(kind).known) << name_of(kind);
    EXPECT_FALSE(alarm(kind).active);
  }
  boot_up();
  alarms_->on_control(std::nullopt, wall_);
  for (const AlarmKind kind : kAlarmKinds) {
    EXPECT_FALSE(alarm(kind).known) << name_of(kind);
  }
  EXPECT_TRUE(told_.empty());
}

TEST_F(MemoryOfAlarmsTest, WithoutMemoryAMissingDriveDecidesAll) {
  find_missing();
  for (const AlarmKind kind : kAlarmKinds) {
    EXPECT_TRUE(alarm(kind).known) << name_of(kind);
    EXPECT_EQ(alarm(kind).active, kind == AlarmKind::heartbeat) << name_of(kind);
  }
  EXPECT_FALSE(alarm(AlarmKind::emcy).confirmed);
  EXPECT_EQ(told_, std::vector<AlarmKind>(kAlarmKinds.begin(), kAlarmKinds.end()));
}

TEST_F(MemoryOfAlarmsTest, WithoutMemoryADriveThatCannotBeBootedDecidesAll) {
  find_not_bootable();
  for (const AlarmKind kind : kAlarmKinds) {
    EXPECT_TRUE(alarm(kind).known) << name_of(kind);
    EXPECT_EQ(alarm(kind).active, kind == AlarmKind::boot) << name_of(kind);
  }
}

TEST_F(MemoryOfAlarmsTest, WithoutMemoryAnArrivedDriveIsAskedForItsErrorsFirst) {
  come_online();
  EXPECT_TRUE(alarm(AlarmKind::heartbeat).known);
  EXPECT_TRUE(alarm(AlarmKind::boot).known);
  EXPECT_FALSE(emcy_alarm().known);
  fault(false);
  EXPECT_FALSE(emcy_alarm().known) << "0x1001 may tell more";
  readings({.error_register = std::uint8_t{0}, .fault_code = {}, .history = {}});
  EXPECT_TRUE(emcy_alarm().known);
  EXPECT_TRUE(emcy_alarm().confirmed);
  EXPECT_EQ(emcy_alarm().ts, WallTime{}) << "that there is none is no change";
}

TEST_F(MemoryOfAlarmsTest, WithoutErrorRegisterTheBitsTell) {
  come_online();
  readings({.register_absent = true});
  EXPECT_FALSE(emcy_alarm().known);
  fault(false);
  EXPECT_TRUE(emcy_alarm().known);
}

TEST_F(MemoryOfAlarmsTest, WithoutErrorRegisterAndBitsNothingIsWaitedFor) {
  model_.faults.fault.reset();
  model_.faults.warning.reset();
  build();
  come_online();
  EXPECT_FALSE(emcy_alarm().known);
  readings({.register_absent = true});
  EXPECT_TRUE(emcy_alarm().known);
}

TEST_F(MemoryOfAlarmsTest, ABitThatNeverComesIsNotWaitedForForever) {
  come_online();
  readings({.register_absent = true});
  settle();
  EXPECT_TRUE(emcy_alarm().known);
}

TEST_F(MemoryOfAlarmsTest, WhatTheDriveTellsIsKnownAtOnce) {
  emcy(0x0004);
  EXPECT_TRUE(emcy_alarm().known);
  EXPECT_TRUE(emcy_alarm().active);
}

TEST_F(MemoryOfAlarmsTest, DataIsKnownWhenAllCameOrSomethingIsMissing) {
  come_online();
  EXPECT_FALSE(alarm(AlarmKind::data).known) << "TPDOs may be overdue in a moment";
  alarms_->on_data_problems({}, wall_);
  EXPECT_TRUE(alarm(AlarmKind::data).known);
  EXPECT_FALSE(alarm(AlarmKind::data).active);
  build();
  come_online();
  alarms_->on_data_problems({{DataReason::overdue, "TPDO1 is overdue"}}, wall_);
  EXPECT_TRUE(alarm(AlarmKind::data).known);
  EXPECT_TRUE(alarm(AlarmKind::data).active);
}

TEST_F(MemoryOfAlarmsTest, DataOfADriveThatIsNotToRunIsKnown) {
  come_online();
  status_.nmt = canopen::NmtState::pre_operational;
  alarms_->on_status(status_, wall_);
  EXPECT_TRUE(alarm(AlarmKind::data).known);
}

TEST_F(MemoryOfAlarmsTest, PatienceEndsForWhatIsNotKnownOnly) {
  alarms_->restore(AlarmKind::heartbeat, active("no heartbeat"));
  alarms_->on_patience_over(wall_);
  for (const AlarmKind kind : kAlarmKinds) {
    EXPECT_TRUE(alarm(kind).known) << name_of(kind);
  }
  expect_as_it_was(AlarmKind::heartbeat, active("no heartbeat"));
}

TEST_F(MemoryOfAlarmsTest, EachKindIsShownAsItWasUntilDecided) {
  for (const AlarmKind kind : kAlarmKinds) {
    alarms_->restore(kind, active("text"));
  }
  EXPECT_EQ(told_, std::vector<AlarmKind>(kAlarmKinds.begin(), kAlarmKinds.end()));
  EXPECT_TRUE(alarms_->any(Severity::fault));
  boot_up();
  alarms_->on_control(std::nullopt, wall_);
  for (const AlarmKind kind : kAlarmKinds) {
    expect_as_it_was(kind, active("text"));
  }
}

TEST_F(MemoryOfAlarmsTest, WhatWasOverIsShownAsItWas) {
  for (const AlarmKind kind : kAlarmKinds) {
    alarms_->restore(kind, over());
    expect_as_it_was(kind, over());
  }
  emcy(0x0004);
  EXPECT_EQ(emcy_alarm().count, 8U);
  EXPECT_EQ(emcy_alarm().id, "id1");
  EXPECT_EQ(emcy_alarm().since, wall_);
  EXPECT_FALSE(emcy_alarm().first);
}

TEST_F(MemoryOfAlarmsTest, AMissingDriveKeepsItsAlarmOfBefore) {
  alarms_->restore(AlarmKind::heartbeat, active("no heartbeat for 1000 ms"));
  alarms_->restore(AlarmKind::boot, active("A: no"));
  alarms_->restore(AlarmKind::data, active("TPDO1 is overdue"));
  find_missing();
  expect_goes_on(AlarmKind::heartbeat);
  EXPECT_EQ(alarm(AlarmKind::heartbeat).text, "the drive has not appeared on the bus");
  expect_ended(AlarmKind::boot);
  expect_ended(AlarmKind::data);
}

TEST_F(MemoryOfAlarmsTest, ADriveThatIsThereEndsWhatIsOver) {
  alarms_->restore(AlarmKind::heartbeat, active("no heartbeat"));
  alarms_->restore(AlarmKind::boot, active("A: no"));
  alarms_->restore(AlarmKind::data, active("TPDO1 is overdue"));
  come_online();
  expect_ended(AlarmKind::heartbeat);
  expect_ended(AlarmKind::boot);
  expect_as_it_was(AlarmKind::data, active("TPDO1 is overdue"));
  alarms_->on_data_problems({}, wall_);
  expect_ended(AlarmKind::data);
}

TEST_F(MemoryOfAlarmsTest, WhatIsStillTrueGoesOn) {
  alarms_->restore(AlarmKind::boot, active("A: no"));
  find_not_bootable();
  expect_goes_on(AlarmKind::boot);
  build();
  status_ = {};
  alarms_->restore(AlarmKind::data, active("TPDO1 is overdue"));
  come_online();
  alarms_->on_data_problems({{DataReason::overdue, "TPDO2 is overdue"}}, wall_);
  expect_goes_on(AlarmKind::data);
  alarms_->on_data_problems({}, wall_);
  expect_ended(AlarmKind::data);
}

TEST_F(MemoryOfAlarmsTest, ControlEndsByTheNextCommand) {
  alarms_->restore(AlarmKind::control, active("no sign of life"));
  come_online();
  settle();
  alarms_->on_running(wall_);
  expect_as_it_was(AlarmKind::control, active("no sign of life"));
  alarms_->on_control_command(wall_);
  expect_ended(AlarmKind::control);
  alarms_->on_control(ControlAlarm{ControlReason::timeout, "again"}, wall_);
  EXPECT_EQ(alarm(AlarmKind::control).count, 8U);
  alarms_->on_control_command(wall_);
  EXPECT_TRUE(alarm(AlarmKind::control).active) << "now it is the arbiter that tells";
}

TEST_F(MemoryOfAlarmsTest, ControlThatActsAgainGoesOn) {
  alarms_->restore(AlarmKind::control, active("no sign of life"));
  alarms_->on_control(ControlAlarm{ControlReason::timeout, "again"}, wall_);
  expect_goes_on(AlarmKind::control);
  alarms_->on_control(std::nullopt, wall_);
  expect_ended(AlarmKind::control);
}

TEST_F(MemoryOfAlarmsTest, ControlThatWasOverIsConfirmedWhenTheDriveIsThere) {
  alarms_->restore(AlarmKind::control, over());
  boot_up();
  expect_as_it_was(AlarmKind::control, over());
  come_online();
  Alarm confirmed = over();
  confirmed.confirmed = true;
  confirmed.ts = alarm(AlarmKind::control).ts;
  EXPECT_EQ(alarm(AlarmKind::control), confirmed);
}

TEST_F(MemoryOfAlarmsTest, ControlThatWasOverIsConfirmedWhenTheDriveIsMissing) {
  alarms_->restore(AlarmKind::control, over());
  find_missing();
  EXPECT_TRUE(alarm(AlarmKind::control).confirmed);
  EXPECT_FALSE(alarm(AlarmKind::control).active);
}

TEST_F(MemoryOfAlarmsTest, WithoutMemoryControlIsKnownWhenTheDriveIsThere) {
  come_online();
  EXPECT_TRUE(alarm(AlarmKind::control).known);
  EXPECT_TRUE(alarm(AlarmKind::control).confirmed);
  EXPECT_FALSE(alarm(AlarmKind::control).active);
}

TEST_F(MemoryOfAlarmsTest, ControlOfADriveThatNobodyCanCommandAnyMoreEndsWhenItIsThere) {
  model_.commands.writers = {};
  build();
  alarms_->restore(AlarmKind::control, active("no sign of life"));
  boot_up();
  expect_as_it_was(AlarmKind::control, active("no sign of life"));
  come_online();
  expect_ended(AlarmKind::control);
}

TEST_F(MemoryOfAlarmsTest, ControlOfADriveWithoutControlCommandEndsWhenItIsMissing) {
  model_.signals.at(model_.find("control_command").value()).name = "other";
  build();
  alarms_->restore(AlarmKind::control, active("no sign of life"));
  find_missing();
  expect_ended(AlarmKind::control);
}

TEST_F(MemoryOfAlarmsTest, AMotorThatRunsEndsItsFeedbackOfBefore) {
  Alarm before = active("the motor does not run");
  before.reason = "feedback";
  alarms_->restore(AlarmKind::control, before);
  alarms_->on_running(wall_);
  expect_ended(AlarmKind::control);
}

TEST_F(MemoryOfAlarmsTest, ADriveOutOfServiceHasNone) {
  model_.enabled = false;
  build();
  alarms_->restore(AlarmKind::heartbeat, active("no heartbeat"));
  alarms_->restore(AlarmKind::emcy, active("x"));
  for (const AlarmKind kind : kAlarmKinds) {
    EXPECT_TRUE(alarm(kind).known) << name_of(kind);
    EXPECT_FALSE(alarm(kind).active) << name_of(kind);
  }
}

TEST_F(MemoryOfAlarmsTest, ErrorsKeepTheirVendorBytesAndSeverity) {
  model_.node.emcy.layout = canopen::EmcyLayout::cia301;
  build();
  Alarm before = active("text");
  before.errors = {{0x1000, {1}, "one", Severity::warning, WallTime(5s)},
                   {0x1000, {2}, "two", Severity::fault, WallTime(6s)}};
  alarms_->restore(AlarmKind::emcy, before);
  come_online();
  emcy(0x1000, 0x01, {2});
  ASSERT_EQ(emcy_alarm().errors.size(), 2U) << "one of them came again";
  EXPECT_EQ(emcy_alarm().errors[0], before.errors[0]);
  EXPECT_EQ(emcy_alarm().errors[1].vendor, before.errors[1].vendor);
  EXPECT_EQ(emcy_alarm().errors[1].since, before.errors[1].since);
  emcy(0x1000, 0x01, {3});
  EXPECT_EQ(emcy_alarm().errors.size(), 3U);
  EXPECT_EQ(emcy_alarm().id, "old");
}

TEST(AlarmId, IsSixteenDigitsAndNeverTheSame) {
  const std::string one = random_id();
  EXPECT_EQ(one.size(), 16U);
  EXPECT_EQ(one.find_first_not_of("0123456789ABCDEF"), std::string::npos);
  EXPECT_NE(one, random_id());
}

}  // namespace
}  // namespace alarms
