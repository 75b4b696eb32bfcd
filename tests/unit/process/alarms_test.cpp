#include "bridges/process/alarms.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "tests/unit/process/test_drive.h"

namespace process {
namespace {

using canopen::Duration;
using canopen::Emcy;
using canopen::TimePoint;
using canopen::WallTime;
using config::Severity;
using namespace std::chrono_literals;

class AlarmsTest : public ::testing::Test {
 protected:
  AlarmsTest() { build(); }

  void build() {
    alarms_ = std::make_unique<Alarms>(model_, [this](AlarmKind kind) { told_.push_back(kind); });
    told_.clear();
  }

  void come_online() {
    status_.online = true;
    status_.configured = true;
    status_.lost = false;
    status_.nmt = canopen::NmtState::operational;
    status_.boot_result = canopen::kBootOk;
    alarms_->on_status(status_, wall_);
  }
  void go_offline(bool lost = true) {
    status_.online = false;
    status_.lost = lost;
    alarms_->on_status(status_, wall_);
  }
  void pass(Duration time) {
    now_ += time;
    wall_ += time;
  }

  void emcy(std::uint16_t code, std::uint8_t error_register = 0x01, std::array<std::uint8_t, 5> vendor = {}) {
    std::array<std::uint8_t, 8> bytes{static_cast<std::uint8_t>(code), static_cast<std::uint8_t>(code >> 8),
                                      error_register};
    std::copy(vendor.begin(), vendor.end(), bytes.begin() + 3);
    alarms_->on_emcy(canopen::decode_emcy(model_.node.emcy, bytes).value(), now_, wall_);
  }
  void reset(std::uint8_t error_register = 0, std::uint8_t remaining = 0) { emcy(0, error_register, {remaining}); }
  void fault(bool set) { alarms_->on_bit(Severity::fault, set, test::kPeriod, now_, wall_); }
  void warning(bool set) { alarms_->on_bit(Severity::warning, set, test::kPeriod, now_, wall_); }
  void readings(const ErrorReadings& readings) { alarms_->on_readings(readings, now_, wall_); }

  [[nodiscard]] const Alarm& emcy_alarm() const { return alarms_->alarm(AlarmKind::emcy); }
  [[nodiscard]] std::vector<std::uint16_t> codes() const {
    std::vector<std::uint16_t> codes;
    for (const AlarmError& error : emcy_alarm().errors) {
      codes.push_back(error.code);
    }
    return codes;
  }
  using Codes = std::vector<std::uint16_t>;

  config::Drive model_ = test::drive();
  canopen::NodeStatus status_;
  std::unique_ptr<Alarms> alarms_;
  std::vector<AlarmKind> told_;
  TimePoint now_{1h};
  WallTime wall_{1000s};
};

TEST_F(AlarmsTest, OverCodesAreTheDrivesOwn) {
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
  readings({});
  EXPECT_TRUE(emcy_alarm().active);
  EXPECT_FALSE(emcy_alarm().confirmed);
  fault(true);
  EXPECT_TRUE(emcy_alarm().confirmed);
  fault(false);
  EXPECT_FALSE(emcy_alarm().active);
}

TEST_F(AlarmsTest, WithoutAnyWitnessTheAlarmStaysUnconfirmedUntilAnEmergency) {
  come_online();
  emcy(0x0004);
  go_offline();
  come_online();
  readings({});
  pass(24h);
  EXPECT_TRUE(emcy_alarm().active);
  EXPECT_FALSE(emcy_alarm().confirmed);
  reset();
  EXPECT_FALSE(emcy_alarm().active);
}

TEST_F(AlarmsTest, ErrorFoundAtArrivalIsNamedByFaultCodeThenHistory) {
  come_online();
  readings({.error_register = std::uint8_t{0x01}, .fault_code = 5, .history = {}});
  EXPECT_EQ(emcy_alarm().code, 5);
  EXPECT_EQ(emcy_alarm().text, "Overcurrent during deceleration");
  EXPECT_TRUE(emcy_alarm().confirmed);

  build();
  come_online();
  readings({.error_register = std::uint8_t{0x01}, .fault_code = 0, .history = std::uint16_t{4}});
  EXPECT_EQ(emcy_alarm().code, 4);
  EXPECT_EQ(emcy_alarm().text, "Overcurrent during acceleration");

  build();
  come_online();
  readings({.error_register = std::uint8_t{0x01}, .fault_code = {}, .history = {}});
  EXPECT_TRUE(emcy_alarm().active);
  EXPECT_EQ(emcy_alarm().text, "drive reports a fault");
}

TEST_F(AlarmsTest, HistoryAloneIsNoError) {
  come_online();
  readings({.error_register = std::uint8_t{0}, .fault_code = 4, .history = std::uint16_t{4}});
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
  alarms_->restore_emcy(before);
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
  alarms_->restore_emcy(before);  // Without its list of errors: the head names the one.
  EXPECT_EQ(codes(), (Codes{4}));
  come_online();
  for (int i = 0; i < 4; ++i) {
    fault(false);
    pass(100ms);
  }
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
  alarms_->restore_emcy(before);
  come_online();
  readings({.error_register = std::uint8_t{0x04}, .fault_code = 1, .history = {}});
  EXPECT_EQ(codes(), (Codes{0x3000}));
}

TEST_F(AlarmsTest, NothingIsRestoredAfterTheDriveArrived) {
  come_online();
  Alarm before;
  before.active = true;
  before.code = 4;
  alarms_->restore_emcy(before);
  EXPECT_FALSE(emcy_alarm().active);
}

TEST_F(AlarmsTest, RestoreJoinsWhatWasHeardMeanwhile) {
  emcy(0x0005);
  Alarm before;
  before.active = true;
  before.id = "old";
  before.count = 7;
  before.since = WallTime(5s);
  before.errors = {{4, {4}, "a", Severity::fault, WallTime(5s)}, {5, {}, "b", Severity::fault, WallTime(6s)}};
  alarms_->restore_emcy(before);
  EXPECT_EQ(codes(), (Codes{4, 5}));
  EXPECT_EQ(emcy_alarm().id, "old");
  EXPECT_EQ(emcy_alarm().count, 7U);
  EXPECT_EQ(emcy_alarm().code, 5);
}

TEST_F(AlarmsTest, BeforeTheFirstArrivalNothingIsConfirmed) {
  EXPECT_FALSE(emcy_alarm().active);
  EXPECT_FALSE(emcy_alarm().confirmed);
  come_online();
  EXPECT_TRUE(emcy_alarm().confirmed);
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
  status_.boot_result = 'C';
  status_.boot_text = "0x1000:00 is 0x00000191, expected 0x00010192";
  alarms_->on_status(status_, wall_);
  const Alarm& alarm = alarms_->alarm(AlarmKind::boot);
  EXPECT_TRUE(alarm.active);
  EXPECT_EQ(alarm.text, "C: 0x1000:00 is 0x00000191, expected 0x00010192");
  status_.boot_text.clear();
  come_online();
  EXPECT_FALSE(alarm.active);
}

TEST_F(AlarmsTest, DataAlarmIsAWarningWithAllTexts) {
  come_online();
  alarms_->on_data_problems({"TPDO1 is overdue", "TPDO2 is overdue"}, wall_);
  const Alarm& alarm = alarms_->alarm(AlarmKind::data);
  EXPECT_TRUE(alarm.active);
  EXPECT_EQ(alarm.severity, Severity::warning);
  EXPECT_EQ(alarm.text, "TPDO1 is overdue; TPDO2 is overdue");
  const std::string id = alarm.id;
  alarms_->on_data_problems({"TPDO2 is overdue"}, wall_);
  EXPECT_EQ(alarm.id, id);
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
}  // namespace process
