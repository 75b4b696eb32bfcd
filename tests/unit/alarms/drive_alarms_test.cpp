// Alarms of every kind: ids, texts, severities.

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/unit/alarms/alarms_fixture.h"

namespace alarms {
namespace {

using namespace std::chrono_literals;

TEST_F(AlarmsTest, UnknownCodeIsShownAsANumber) {
  come_online();
  emcy(0x0011);
  EXPECT_EQ(emcy_alarm().text, "drive fault 17");
}

TEST_F(AlarmsTest, IdIsNewAtEachActivationOnly) {
  come_online();
  emcy(0x0004);
  const std::string first = emcy_alarm().id;
  EXPECT_FALSE(first.empty());
  emcy(0x0005);
  EXPECT_EQ(emcy_alarm().id, first);
  EXPECT_EQ(emcy_alarm().count, 1U);
  reset();
  EXPECT_FALSE(emcy_alarm().active);
  EXPECT_EQ(emcy_alarm().id, first);
  EXPECT_EQ(emcy_alarm().cleared, wall_);
  emcy(0x0004);
  EXPECT_NE(emcy_alarm().id, first);  // Even within the same millisecond.
  EXPECT_EQ(emcy_alarm().count, 2U);
}

TEST_F(AlarmsTest, ClassAndVendorLayoutTakesTheDrivesOwnText) {
  model_.node.emcy.layout = canopen::EmcyLayout::class_and_vendor40;
  model_.faults.drive_texts = {{1, {"OUt1 (inverter unit phase U)", Severity::fault}}};
  model_.faults.emcy_texts = {{0x3000, {"Voltage", Severity::fault}}};
  build();
  come_online();
  emcy(0x3000, 0x04, {1});
  EXPECT_EQ(emcy_alarm().text, "OUt1 (inverter unit phase U)");
  emcy(0x3000, 0x04, {17});
  EXPECT_EQ(emcy_alarm().text, "drive fault 17 (Voltage)");
  emcy(0x3000, 0x04, {});
  EXPECT_EQ(emcy_alarm().text, "Voltage");
  reset();
  EXPECT_FALSE(emcy_alarm().active);
}

TEST_F(AlarmsTest, Cia301LayoutTakesCodeThenClassThenNumber) {
  model_.node.emcy = {};
  model_.faults.drive_texts.clear();
  model_.faults.emcy_texts = {{0x2310, {"Continuous overcurrent on the motor side", Severity::fault}},
                              {0x4000, {"Temperature", Severity::warning}}};
  build();
  come_online();
  emcy(0x2310);
  EXPECT_EQ(emcy_alarm().text, "Continuous overcurrent on the motor side");
  emcy(0x4210);
  EXPECT_EQ(emcy_alarm().errors[1].text, "Temperature");
  EXPECT_EQ(emcy_alarm().errors[1].severity, Severity::warning);
  emcy(0x1000);
  EXPECT_EQ(emcy_alarm().text, "emergency 0x1000");
}

TEST_F(AlarmsTest, OneThatNeverWasHasTheSeverityOfItsKind) {
  const auto expect_severities = [this] {
    for (const AlarmKind kind : kAlarmKinds) {
      const Alarm& alarm = alarms_->alarm(kind);
      EXPECT_FALSE(alarm.active) << name_of(kind);
      EXPECT_EQ(alarm.severity, kind == AlarmKind::data ? Severity::warning : Severity::fault) << name_of(kind);
    }
  };
  come_online();
  alarms_->on_patience_over(wall_);
  expect_severities();
  alarms_->restore(AlarmKind::data, Alarm());  // as older versions kept it
  expect_severities();
  model_.enabled = false;
  build();
  expect_severities();
}

TEST_F(AlarmsTest, HeartbeatAlarm) {
  status_.lost = true;
  alarms_->on_status(status_, wall_);
  const Alarm& alarm = alarms_->alarm(AlarmKind::heartbeat);
  EXPECT_TRUE(alarm.active);
  EXPECT_EQ(alarm.severity, Severity::fault);
  EXPECT_EQ(alarm.text, "the drive has not appeared on the bus");
  come_online();
  EXPECT_FALSE(alarm.active);
  status_.last_heartbeat = now_;
  status_.heartbeat_losses = 1;
  go_offline();
  EXPECT_TRUE(alarm.active);
  EXPECT_EQ(alarm.text, "no heartbeat for 1500 ms");
  EXPECT_EQ(alarm.count, 2U);
}

TEST_F(AlarmsTest, BootAlarmNamesItsLetterAndReason) {
  status_.boot_result = canopen::BootResult::other_device_type;
  status_.boot_text = "0x1000:00 is 0x00000191, expected 0x00010192";
  alarms_->on_status(status_, wall_);
  const Alarm& alarm = alarms_->alarm(AlarmKind::boot);
  EXPECT_TRUE(alarm.active);
  EXPECT_EQ(
      alarm.text,
      "C: another device type than expected: 0x1000:00 is 0x00000191, expected 0x00010192. What to do first: look "
      "whether the planned drive has this node id; if it does, correct identity.device_type or the profile, or, where "
      "it "
      "cannot be read, leave it out");
  status_.boot_text.clear();
  come_online();
  EXPECT_FALSE(alarm.active);
}

TEST_F(AlarmsTest, ABootAlarmWhereNoSettingIsTheCauseSaysSoOnce) {
  status_.boot_result = canopen::BootResult::not_configured;
  status_.held_back = canopen::HeldBack::found_stopped;
  status_.boot_text = "it was found stopped; it is left so until an NMT start command or its boot-up";
  alarms_->on_status(status_, wall_);
  EXPECT_EQ(alarms_->alarm(AlarmKind::boot).text,
            "J: it was found stopped; it is left so until an NMT start command or its boot-up. What to do first: " +
                std::string(first_steps(status_.boot_result, status_.held_back)));
  EXPECT_EQ(alarms_->alarm(AlarmKind::boot).reason, "found-stopped");
}

TEST_F(AlarmsTest, DataAlarmIsAWarningWithAllTexts) {
  come_online();
  alarms_->on_data_problems({{DataReason::overdue, "TPDO1 is overdue"}, {DataReason::too_short, "TPDO2 has 4 bytes"}},
                            wall_);
  const Alarm& alarm = alarms_->alarm(AlarmKind::data);
  EXPECT_TRUE(alarm.active);
  EXPECT_EQ(alarm.severity, Severity::warning);
  EXPECT_EQ(alarm.text, "TPDO1 is overdue; TPDO2 has 4 bytes");
  EXPECT_EQ(alarm.reason, "overdue");
  const std::string id = alarm.id;
  alarms_->on_data_problems({{DataReason::too_short, "TPDO2 has 4 bytes"}}, wall_);
  EXPECT_EQ(alarm.id, id);
  EXPECT_EQ(alarm.reason, "short");
  alarms_->on_data_problems({}, wall_);
  EXPECT_FALSE(alarm.active);
}

TEST_F(AlarmsTest, StatusThatChangesNoAlarmTellsNobody) {
  come_online();
  told_.clear();
  ++status_.emergencies;
  alarms_->on_status(status_, wall_);
  EXPECT_TRUE(told_.empty());
}

TEST_F(AlarmsTest, EveryKindExists) {
  for (const AlarmKind kind : kAlarmKinds) {
    EXPECT_FALSE(alarms_->alarm(kind).active);
    EXPECT_FALSE(name_of(kind).empty());
  }
}

}  // namespace
}  // namespace alarms
