// Which errors of a drive are active, out of real frames: emergencies, status word, and 0x1001 read by SDO.

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/unit/process/drive_bench.h"

namespace process {
namespace {

using canopen::DataType;
using namespace std::chrono_literals;

class DriveErrorsTest : public DriveBench {
 protected:
  static constexpr canopen::ObjectAddress kErrorRegister{0x1001, 0};

  void expect_emcy(bool active, std::uint16_t code) {
    EXPECT_EQ(alarm(alarms::AlarmKind::emcy).active, active);
    EXPECT_EQ(alarm(alarms::AlarmKind::emcy).code, code);
  }
  void hold_register(canopen::Raw value) { slave_.set(kErrorRegister, DataType::u8, value); }
  /// Reads of 0x1001 in the next `time`.
  std::ptrdiff_t reads_within(Duration time) {
    slave_.forget_heard();
    run(time);
    return std::ranges::count(slave_.reads(), kErrorRegister);
  }
  void without_signals() {
    model_.faults.fault.reset();
    model_.faults.warning.reset();
  }
};

TEST_F(DriveErrorsTest, Ac300OvercurrentIsAnAlarmAndTheStatusBitEndsIt) {
  bring_online();
  show(test::kRunningBit);
  emcy(0x0004, 0x01);
  expect_emcy(true, 0x0004);
  EXPECT_EQ(alarm(alarms::AlarmKind::emcy).text, "Overcurrent during acceleration");
  EXPECT_TRUE(drive_->has_fault_alarm());
  show(test::kFaultBit);
  run(1s);
  expect_emcy(true, 0x0004);
  // The manual describes no recovery frame: the bit alone has to do.
  show(0);
  expect_emcy(false, 0x0004);
  EXPECT_EQ(alarm(alarms::AlarmKind::emcy).count, 1U);
}

TEST_F(DriveErrorsTest, FaultBitWithoutEmergencyTakesTheFaultCode) {
  bring_online();
  fault_code_ = 5;
  show(test::kFaultBit);
  expect_emcy(true, 5);
  EXPECT_EQ(alarm(alarms::AlarmKind::emcy).text, "Overcurrent during deceleration");
}

TEST_F(DriveErrorsTest, ErrorOfAnArrivingDriveIsFoundByItsRegister) {
  model_.faults.fault.reset();
  model_.faults.warning.reset();
  slave_.set({0x1001, 0}, DataType::u8, 0x01);
  slave_.set({0x1003, 1}, DataType::u32, 0xABCD0004);
  bring_online();
  expect_emcy(true, 4);
  EXPECT_TRUE(alarm(alarms::AlarmKind::emcy).confirmed);
  EXPECT_EQ(alarm(alarms::AlarmKind::emcy).error_register, 0x01);
}

TEST_F(DriveErrorsTest, FaultBitOfAnArrivingDriveIsNamedByItsHistory) {
  slave_.set({0x1001, 0}, DataType::u8, 0x01);
  slave_.set({0x1003, 1}, DataType::u32, 0x0004);
  status_word_ = test::kFaultBit;
  bring_online();
  expect_emcy(true, 4);
  EXPECT_EQ(alarm(alarms::AlarmKind::emcy).errors.size(), 1U);
  EXPECT_EQ(alarm(alarms::AlarmKind::emcy).severity, config::Severity::fault);
}

TEST_F(DriveErrorsTest, AnErrorRegisterThatIsSetIsAnErrorUnderClearBitsToo) {
  hold_register(0x80);
  bring_online();
  expect_emcy(true, 0);
  EXPECT_EQ(alarm(alarms::AlarmKind::emcy).error_register, 0x80);
  hold_register(0x00);
  run(1100ms);
  expect_emcy(false, 0);
}

TEST_F(DriveErrorsTest, AnErrorRegisterThatDoesNotFollowTheFaultsIsNone) {
  model_.faults.error_register_follows = false;
  hold_register(0x80);
  bring_online();
  EXPECT_FALSE(alarm(alarms::AlarmKind::emcy).active);
  EXPECT_TRUE(alarm(alarms::AlarmKind::emcy).confirmed);
  EXPECT_EQ(alarm(alarms::AlarmKind::emcy).error_register, 0x80) << "but it is shown";
  emcy(0x0004, 0x81);
  show(test::kFaultBit);
  expect_emcy(true, 4);
  show(0);
  expect_emcy(false, 4);
  EXPECT_EQ(reads_within(5s), 0);
}

TEST_F(DriveErrorsTest, WithoutAFaultSignalTheErrorRegisterIsWatched) {
  without_signals();
  bring_online();
  EXPECT_EQ(reads_within(60s), 0);
  hold_register(0x01);
  emcy(0x0004, 0x01);
  EXPECT_EQ(reads_within(950ms), 0);
  const std::ptrdiff_t often = reads_within(60s);
  EXPECT_GE(often, 55);
  EXPECT_LE(often, 61);
  const std::ptrdiff_t seldom = reads_within(60s);
  EXPECT_GE(seldom, 5);
  EXPECT_LE(seldom, 7);
  expect_emcy(true, 4);
  emcy(0x0005, 0x01);
  EXPECT_GE(reads_within(10s), 8);
  hold_register(0x00);
  run(1100ms);
  expect_emcy(false, 5);
  EXPECT_EQ(reads_within(60s), 0);
}

TEST_F(DriveErrorsTest, ABitThatWentClearAsksForTheErrorRegisterAtOnce) {
  bring_online();
  hold_register(0x01);
  emcy(0x0004, 0x01);
  show(test::kFaultBit);
  EXPECT_EQ(reads_within(30s), 0) << "the bit tells";
  show(0);
  run(2s);
  expect_emcy(true, 4);
  hold_register(0x00);
  run(1100ms);
  expect_emcy(false, 4);
}

TEST_F(DriveErrorsTest, ADriveWithoutTheErrorRegisterIsNotAskedAgain) {
  slave_.remove(kErrorRegister);
  bring_online();
  emcy(0x0004, 0x01);
  show(test::kFaultBit);
  EXPECT_EQ(reads_within(30s), 0);
  show(0);
  expect_emcy(false, 4);
}

TEST_F(DriveErrorsTest, PollsGoOnWhileTheErrorRegisterDoesNotAnswer) {
  without_signals();
  bring_online();
  emcy(0x0004, 0x01);
  slave_.mute(kErrorRegister);
  EXPECT_GE(reads_within(20s), 3);
  EXPECT_GE(std::ranges::count(slave_.reads(), test::kTemperature), 5);
  expect_emcy(true, 4);
}

TEST_F(DriveErrorsTest, AStatusWordThatDoesNotComeLeavesItToTheErrorRegister) {
  bring_online();
  hold_register(0x01);
  emcy(0x0004, 0x01);
  show(test::kFaultBit);
  silent_ = true;
  slave_.mute(test::kStatusWord);  // Nor by SDO.
  run(3s);
  expect_emcy(true, 4);
  hold_register(0x00);
  run(5s);
  expect_emcy(false, 4);
}

TEST_F(DriveErrorsTest, AStatusWordOnChangeThatCannotBeReadLeavesItToTheErrorRegister) {
  model_.node.tpdos[0].period = {};
  bring_online();
  silent_ = true;  // Nothing changes.
  slave_.mute(test::kStatusWord);
  hold_register(0x01);
  emcy(0x0004, 0x01);
  run(5s);
  expect_emcy(true, 4);
  EXPECT_GE(reads_within(10s), 3) << "nothing else tells";
  hold_register(0x00);
  run(12s);
  expect_emcy(false, 4);
}

TEST_F(DriveErrorsTest, AnErrorRegisterThatDoesNotAnswerTakesLittleOfTheDrivesSdo) {
  without_signals();
  bring_online();
  emcy(0x0004, 0x01);
  slave_.mute(kErrorRegister);
  run(3s);
  EXPECT_LE(reads_within(60s), 18) << "three tries each ten seconds";
  expect_emcy(true, 4);
  slave_.unmute(kErrorRegister);
  hold_register(0x00);
  run(12s);
  expect_emcy(false, 4);
}

TEST_F(DriveErrorsTest, ALongBootIsWaitedForBeforeAlarmsCountAsOver) {
  model_.node.sdo.timeout = 40s;
  slave_.mute_sdo(true);
  start();
  slave_.boot_up();
  run(30s);
  EXPECT_FALSE(alarm(alarms::AlarmKind::boot).known) << "nobody knows how it ends";
  slave_.boot_up();
  run(2s);
  EXPECT_TRUE(alarm(alarms::AlarmKind::boot).known) << "it restarts, and may do so for ever";
}

}  // namespace
}  // namespace process
