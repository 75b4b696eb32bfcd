// What errors are called, and whether they are faults: fault code, history, and the signals.

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/unit/alarms/alarms_fixture.h"

namespace alarms {
namespace {

using namespace std::chrono_literals;

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
  reads(0x00);
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
  reads(0x00);
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

TEST_F(AlarmsTest, AnotherFaultThatCameUnheardIsNamedByTheFaultCode) {
  emcy(0x0004);
  come_online();
  fault(true);
  alarms_->on_fault_code(0x04, wall_);
  EXPECT_EQ(codes(), (Codes{4}));
  go_offline();
  come_online();
  alarms_->on_fault_code(0x05, wall_);
  fault(true);
  EXPECT_EQ(codes(), (Codes{4, 5})) << "perhaps the drive has both";
  EXPECT_EQ(emcy_alarm().code, 5);
  EXPECT_EQ(emcy_alarm().count, 1U);
  alarms_->on_fault_code(0x06, wall_);
  fault(true);
  EXPECT_EQ(codes().size(), 2U) << "raised once, renamed then";
  fault(false);
  reads(0x00);
  EXPECT_FALSE(emcy_alarm().active);
}

TEST_F(AlarmsTest, AnErrorWithoutANumberOfTheDriveIsNotListedTwice) {
  model_.node.emcy.layout = canopen::EmcyLayout::cia301;
  build();
  come_online();
  emcy(0x1000, 0x81, {1, 2, 3});
  fault(true);
  go_offline();
  come_online();
  alarms_->on_fault_code(0x05, wall_);
  fault(true);
  EXPECT_EQ(codes(), (Codes{0x1000}));
}

TEST_F(AlarmsTest, AFaultCodeThatIsAnEmcyCodeNamesAnotherFault) {
  model_.node.emcy.layout = canopen::EmcyLayout::cia301;
  model_.faults.drive_texts.clear();
  build();
  come_online();
  emcy(0x2310);
  fault(true);
  go_offline();
  come_online();
  alarms_->on_fault_code(0x2310, wall_);
  fault(true);
  EXPECT_EQ(codes(), (Codes{0x2310}));
  alarms_->on_fault_code(0x3210, wall_);
  fault(true);
  EXPECT_EQ(codes(), (Codes{0x2310, 0x3210}));
}

}  // namespace
}  // namespace alarms
