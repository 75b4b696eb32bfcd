// A drive as the bridges see it: values, freshness, status and alarms out of real frames.

#include "bridges/process/drive.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "tests/unit/process/drive_bench.h"

namespace process {
namespace {

using canopen::DataType;
using namespace std::chrono_literals;

class DriveTest : public DriveBench {
 protected:
  [[nodiscard]] bool told(alarms::AlarmKind kind) const { return std::ranges::count(observer_.alarms, kind) > 0; }
  void expect_emcy(bool active, std::uint16_t code) {
    EXPECT_EQ(alarm(alarms::AlarmKind::emcy).active, active);
    EXPECT_EQ(alarm(alarms::AlarmKind::emcy).code, code);
  }
  [[nodiscard]] std::ptrdiff_t reads_of(canopen::ObjectAddress object) const {
    return std::ranges::count(slave_.reads(), object);
  }
};

TEST_F(DriveTest, ValuesOfOneTpdoAreToldInOneGo) {
  bring_online();
  observer_.values.clear();
  show(test::kRunningBit);
  ASSERT_EQ(observer_.values.size(), 2U);
  EXPECT_EQ(observer_.values[0],
            (std::vector<SignalId>{signal("status_word"), signal("output_frequency"), signal("running"),
                                   signal("reverse"), signal("fault"), signal("warning")}));
  EXPECT_EQ(observer_.values[1], std::vector<SignalId>{signal("fault_code")});
  EXPECT_EQ(drive_->image().raw(signal("output_frequency")), 4997U);
  EXPECT_EQ(drive_->image().raw(signal("running")), 1U);
  EXPECT_TRUE(drive_->image().all_fresh(canopen::Clock::now()));
  EXPECT_EQ(drive_->image().source_of(signal("running"))->at, canopen::Clock::now());
}

TEST_F(DriveTest, PolledValuesComeBySdo) {
  slave_.set(test::kTemperature, DataType::i16, static_cast<canopen::Raw>(-5));
  bring_online();
  EXPECT_TRUE(fresh("module_temperature"));
  EXPECT_EQ(drive_->image().raw(signal("module_temperature")), static_cast<canopen::Raw>(-5));
  run(4s);
  EXPECT_EQ(reads_of(test::kTemperature), 10);
  EXPECT_EQ(reads_of(test::kLimit), 4);
}

TEST_F(DriveTest, SilentTpdosAreTakenForOverdueAndReadBySdo) {
  slave_.set(test::kOutput, DataType::u16, 1234);
  bring_online();
  silent_ = true;
  observer_.stale.clear();
  run(299ms);
  EXPECT_TRUE(fresh("running"));
  run(10ms);
  EXPECT_EQ(observer_.stale.size(), 2U);
  EXPECT_TRUE(fresh("running")) << "its type was only assumed, so its objects are read";
  EXPECT_EQ(drive_->image().raw(signal("output_frequency")), 1234U);
  run(10s);
  EXPECT_TRUE(fresh("running"));
  EXPECT_FALSE(alarm(alarms::AlarmKind::data).active);
}

TEST_F(DriveTest, OverdueTpdoThatCannotBeReadIsADataAlarm) {
  bring_online();
  slave_.remove(test::kFaultCode);
  fault_code_readable_ = false;
  silent_ = true;
  run(2s);
  EXPECT_TRUE(alarm(alarms::AlarmKind::data).active);
  EXPECT_EQ(alarm(alarms::AlarmKind::data).text.rfind("TPDO2 is overdue", 0), 0U)
      << alarm(alarms::AlarmKind::data).text;
  EXPECT_TRUE(told(alarms::AlarmKind::data));
  EXPECT_TRUE(drive_->has_warning_alarm());
  EXPECT_FALSE(drive_->has_fault_alarm());
  silent_ = false;
  run(300ms);
  EXPECT_FALSE(alarm(alarms::AlarmKind::data).active);
}

TEST_F(DriveTest, TpdoOfAnotherLengthIsNotDecoded) {
  bring_online();
  silent_ = true;
  slave_.send(0x185, {1, 0, 0, 0});
  run(1ms);
  EXPECT_EQ(drive_->image().raw(signal("running")), 0U);
  EXPECT_TRUE(alarm(alarms::AlarmKind::data).active);
  EXPECT_EQ(alarm(alarms::AlarmKind::data).text, "TPDO1 has 4 bytes, expected 6, and is not decoded");
  silent_ = false;
  run(200ms);
  EXPECT_FALSE(alarm(alarms::AlarmKind::data).active);
}

TEST_F(DriveTest, LossMakesValuesStaleAndRaisesHeartbeat) {
  bring_online();
  show(test::kRunningBit);
  slave_.unplug(true);
  run(2s);
  EXPECT_FALSE(drive_->status().online);
  EXPECT_FALSE(fresh("running"));
  EXPECT_TRUE(alarm(alarms::AlarmKind::heartbeat).active);
  EXPECT_FALSE(alarm(alarms::AlarmKind::data).active) << "the drive does not live";
  EXPECT_TRUE(drive_->has_fault_alarm());
  slave_.unplug(false);
  run(5s);
  EXPECT_TRUE(drive_->status().online);
  EXPECT_TRUE(fresh("running"));
  EXPECT_FALSE(alarm(alarms::AlarmKind::heartbeat).active);
}

TEST_F(DriveTest, DriveThatNeverAppearsIsAHeartbeatAlarm) {
  slave_.unplug(true);
  start();
  run(3s);
  EXPECT_TRUE(alarm(alarms::AlarmKind::heartbeat).active);
  EXPECT_EQ(alarm(alarms::AlarmKind::heartbeat).text, "the drive has not appeared on the bus");
}

TEST_F(DriveTest, RestoredAlarmEndsWhereTheDriveTellsNone) {
  slave_.unplug(true);
  start();
  alarms::Alarm before;
  before.active = true;
  before.id = "old";
  before.code = 4;
  before.text = "Overcurrent during acceleration";
  before.errors = {{4, {4}, "Overcurrent during acceleration", config::Severity::fault, {}}};
  drive_->restore(alarms::AlarmKind::emcy, before);
  run(1s);
  EXPECT_TRUE(alarm(alarms::AlarmKind::emcy).active);
  EXPECT_FALSE(alarm(alarms::AlarmKind::emcy).confirmed);
  slave_.unplug(false);
  slave_.boot_up();
  run(3s);
  ASSERT_TRUE(drive_->status().online);
  EXPECT_FALSE(alarm(alarms::AlarmKind::emcy).active);
  EXPECT_TRUE(alarm(alarms::AlarmKind::emcy).confirmed);
}

TEST_F(DriveTest, RestoredAlarmOfADriveThatNothingTellsOfEndsWithItsBootUp) {
  slave_.remove({0x1001, 0});
  model_.faults.fault.reset();
  model_.faults.warning.reset();
  start();
  alarms::Alarm before;
  before.active = true;
  before.id = "old";
  before.errors = {{4, {4}, "Overcurrent during acceleration", config::Severity::fault, {}}};
  drive_->restore(alarms::AlarmKind::emcy, before);
  run(100ms);
  EXPECT_TRUE(alarm(alarms::AlarmKind::emcy).active);
  EXPECT_FALSE(alarm(alarms::AlarmKind::emcy).confirmed);
  slave_.boot_up();
  run(10s);
  ASSERT_TRUE(drive_->status().online);
  EXPECT_FALSE(alarm(alarms::AlarmKind::emcy).active);
}

TEST_F(DriveTest, EmergencyDuringTheCheckIsNotClearedByAnOlderAnswer) {
  bring_online();
  slave_.boot_up();
  slave_.delay_answers(40ms);
  bool sent = false;
  for (int i = 0; i < 4000 && !sent; ++i) {
    slave_.forget_heard();
    run(1ms);
    if (drive_->status().online && reads_of({0x1001, 0}) > 0) {
      emcy(0x0004, 0x01);
      sent = true;
    }
  }
  ASSERT_TRUE(sent);
  run(60ms);
  expect_emcy(true, 4);
}

TEST_F(DriveTest, OfflineAlarmStaysUnconfirmed) {
  bring_online();
  emcy(0x0004, 0x01);
  slave_.unplug(true);
  run(2s);
  expect_emcy(true, 4);
  EXPECT_FALSE(alarm(alarms::AlarmKind::emcy).confirmed);
}

TEST_F(DriveTest, OnChangeStatusIsReadUntilTheEmergencyIsDecided) {
  model_.node.tpdos[0].period = {};
  bring_online();
  run(5s);
  silent_ = true;
  slave_.forget_heard();
  run(3s);
  EXPECT_EQ(reads_of(test::kStatusWord), 0);
  emcy(0x0004, 0x01);
  slave_.set(test::kStatusWord, DataType::u16, 0);
  run(6s);
  EXPECT_GE(reads_of(test::kStatusWord), 4);
  expect_emcy(false, 4);
  slave_.forget_heard();
  run(5s);
  EXPECT_EQ(reads_of(test::kStatusWord), 0);
}

TEST_F(DriveTest, BootErrorIsABootAlarm) {
  model_.node.identity.device_type = 0x00010192;
  start();
  slave_.boot_up();
  run(1s);
  EXPECT_TRUE(alarm(alarms::AlarmKind::boot).active);
  EXPECT_EQ(alarm(alarms::AlarmKind::boot).text.substr(0, 2), "C:");
  EXPECT_FALSE(drive_->status().online);
}

TEST_F(DriveTest, AnErrorThatKeepsItFromStartingIsTold) {
  slave_.set({0x1001, 0}, canopen::DataType::u8, 0x01);
  slave_.ignore_nmt(true);
  fault_code_readable_ = false;
  slave_.set(test::kFaultCode, canopen::DataType::u16, 4);
  start();
  slave_.boot_up();
  run(2500ms);
  EXPECT_FALSE(drive_->status().online);
  EXPECT_TRUE(drive_->alarm(alarms::AlarmKind::boot).active);
  EXPECT_NE(drive_->alarm(alarms::AlarmKind::boot).text.find("its error register 0x1001 is 0x01"), std::string::npos)
      << drive_->alarm(alarms::AlarmKind::boot).text;
  EXPECT_TRUE(drive_->alarm(alarms::AlarmKind::emcy).active);
}

TEST_F(DriveTest, LeavingOperationalByItselfIsABootAlarm) {
  bring_online();
  slave_.set_state(127);
  run(600ms);
  EXPECT_TRUE(alarm(alarms::AlarmKind::boot).active);
  EXPECT_FALSE(fresh("running"));
}

TEST_F(DriveTest, StatusIsToldOnEachChange) {
  bring_online();
  const int before = observer_.statuses;
  run(3s);
  EXPECT_EQ(observer_.statuses, before) << "heartbeats alone change nothing";
  slave_.boot_up();
  run(3s);
  EXPECT_GT(observer_.statuses, before);
  EXPECT_EQ(drive_->status().boot_ups, 2U);
}

TEST_F(DriveTest, StopEndsEverythingEvenWhileReading) {
  bring_online();
  slave_.mute_sdo(true);
  run(2s);
  stop();
}

}  // namespace
}  // namespace process
