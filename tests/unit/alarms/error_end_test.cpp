// When an error is over: emergencies, the fault and warning bits and 0x1001 together.

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/unit/alarms/alarms_fixture.h"

namespace alarms {
namespace {

using namespace std::chrono_literals;

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
  EXPECT_FALSE(undecided());
  fault(false);
  EXPECT_TRUE(emcy_alarm().active);
  EXPECT_TRUE(undecided());
  reads(0x01);
  EXPECT_TRUE(emcy_alarm().active);
  reads(0x00);
  EXPECT_FALSE(emcy_alarm().active);
  EXPECT_FALSE(undecided());
}

TEST_F(AlarmsTest, ClearBitAloneTakesThreePeriods) {
  come_online();
  fault(false);
  pass(100ms);
  emcy(0x0004);
  for (int i = 0; i < 3; ++i) {
    pass(100ms);
    fault(false);
    EXPECT_FALSE(undecided()) << i;
  }
  pass(100ms);
  fault(false);
  EXPECT_TRUE(undecided());
  reads(0x01);
  EXPECT_TRUE(emcy_alarm().active);
  reads(0x00);
  EXPECT_FALSE(emcy_alarm().active);
}

TEST_F(AlarmsTest, WhereTheErrorRegisterDoesNotFollowTheBitAloneTellsTheEnd) {
  build_without_following_register();
  come_online();
  emcy(0x0004, 0x81);
  fault(true);
  reads(0x81);
  pass(100ms);
  reads(0x00);
  EXPECT_TRUE(emcy_alarm().active);
  fault(false);
  EXPECT_FALSE(emcy_alarm().active);
  readings({.error_register = std::uint8_t{0x81}, .fault_code = 4, .history = {}});
  EXPECT_FALSE(emcy_alarm().active) << "nor does it raise one";
  emcy(0x0005, 0x81);
  for (int i = 0; i < 4; ++i) {
    EXPECT_TRUE(emcy_alarm().active) << i;
    EXPECT_FALSE(undecided()) << "there is nothing to ask for";
    pass(100ms);
    fault(false);
  }
  EXPECT_FALSE(emcy_alarm().active);
}

TEST_F(AlarmsTest, ABootUpEndsWhatNothingElseCanTellTheEndOf) {
  model_.node.emcy.layout = canopen::EmcyLayout::cia301;
  build_without_following_register();
  come_online();
  emcy(0x8130, 0x11);
  emcy(0x2310, 0x02);
  go_offline();
  alarms_->on_boot_up(now_, wall_);
  EXPECT_EQ(codes(), (Codes{0x2310})) << "of that the signal will tell";
  come_online();
  emcy(0x8130, 0x11);
  pass(1h);
  fault(false);
  EXPECT_TRUE(emcy_alarm().active) << "told anew";
}

TEST_F(AlarmsTest, ABootUpEndsNothingThatTheErrorRegisterTellsOf) {
  model_.node.emcy.layout = canopen::EmcyLayout::cia301;
  build();
  come_online();
  emcy(0x8130, 0x11);
  go_offline();
  alarms_->on_boot_up(now_, wall_);
  EXPECT_TRUE(emcy_alarm().active);
  come_online();
  readings({.error_register = std::uint8_t{0}, .fault_code = {}, .history = {}});
  EXPECT_FALSE(emcy_alarm().active);
}

TEST_F(AlarmsTest, AReadingFromBeforeTheBitWentClearDoesNotCount) {
  come_online();
  emcy(0x0004);
  fault(true);
  pass(100ms);
  reads(0x00);
  EXPECT_TRUE(emcy_alarm().active) << "the bit holds it";
  pass(100ms);
  fault(false);
  EXPECT_TRUE(emcy_alarm().active);
  pass(50ms);
  reads(0x00, 100ms);
  EXPECT_TRUE(emcy_alarm().active) << "asked for before";
  reads(0x00, 50ms);
  EXPECT_FALSE(emcy_alarm().active);
}

TEST_F(AlarmsTest, AReadingFromBeforeTheEmergencyDoesNotCount) {
  come_online();
  emcy(0x0004);
  pass(1s);
  emcy(0x0004);
  reads(0x00, 10ms);
  EXPECT_TRUE(emcy_alarm().active);
}

TEST_F(AlarmsTest, ValueSeenSetBeforeTheEmergencyDoesNotCount) {
  come_online();
  emcy(0x0004);
  fault(true);
  pass(100ms);
  emcy(0x0004);  // Again, newer than the bit.
  pass(10ms);
  fault(false);
  EXPECT_FALSE(undecided());
  for (int i = 0; i < 3; ++i) {
    EXPECT_TRUE(emcy_alarm().active) << i;
    pass(100ms);
    fault(false);
  }
  EXPECT_TRUE(undecided());
}

TEST_F(AlarmsTest, ACommunicationErrorUnderACleanStatusWordStaysUntilTheErrorRegisterIsClear) {
  model_.node.emcy = {};
  build();
  come_online();
  fault(false);
  emcy(0x8130, 0x11);
  for (int i = 0; i < 50; ++i) {
    pass(100ms);
    fault(false);
    reads(0x11);
    EXPECT_TRUE(emcy_alarm().active);
    EXPECT_TRUE(undecided());
  }
  reads(0x00);
  EXPECT_FALSE(emcy_alarm().active);
}

TEST_F(AlarmsTest, AnOvercurrentBesideACommunicationErrorEndsUnderItsBitsOfTheErrorRegister) {
  model_.node.emcy = {};
  build();
  come_online();
  emcy(0x8130, 0x11);
  emcy(0x2310, 0x13);
  fault(true);
  pass(100ms);
  fault(false);
  reads(0x13);
  EXPECT_EQ(codes(), (Codes{0x8130, 0x2310}));
  reads(0x11);
  EXPECT_EQ(codes(), (Codes{0x8130}));
  reads(0x00);
  EXPECT_FALSE(emcy_alarm().active);
}

TEST_F(AlarmsTest, ADrivesOwnCodeIsOfNoClass) {
  come_online();  // Its layout carries numbers of its own.
  emcy(0x8130, 0x01);
  fault(true);
  fault(false);
  emcy(0x0005, 0x01);
  fault(true);
  fault(false);
  reads(0x11);
  EXPECT_EQ(codes(), (Codes{0x8130, 5})) << "neither explains the bits that are left";
}

TEST_F(AlarmsTest, WithoutABitOnlyTheErrorRegisterOrAnEmergencyTellsTheEnd) {
  model_.faults.fault.reset();
  build();
  come_online();
  emcy(0x0004);
  EXPECT_TRUE(undecided());
  pass(24h);
  reads(0x01);
  EXPECT_TRUE(emcy_alarm().active);
  reads(0x00);
  EXPECT_FALSE(emcy_alarm().active);
}

TEST_F(AlarmsTest, ABitThatIsNotReceivedAnyMoreHoldsNothing) {
  come_online();
  emcy(0x0004);
  fault(true);
  reads(0x00);
  EXPECT_TRUE(emcy_alarm().active);
  EXPECT_FALSE(undecided());
  pass(400ms);
  alarms_->on_stale_bit(Severity::fault, now_);
  EXPECT_TRUE(emcy_alarm().active);
  EXPECT_TRUE(undecided());
  reads(0x00);
  EXPECT_FALSE(emcy_alarm().active);
}

TEST_F(AlarmsTest, NothingIsAskedForWhileTheDriveIsOffline) {
  model_.faults.fault.reset();
  build();
  come_online();
  emcy(0x0004);
  EXPECT_TRUE(undecided());
  go_offline();
  EXPECT_FALSE(undecided());
}

TEST_F(AlarmsTest, WarningBitClearsWarningsAndFaultBitFaults) {
  build_without_following_register();
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

// One class of emergency stands for many faults of the drive.
TEST_F(AlarmsTest, ErrorsOfOneCodeAreRestoredByTheirVendorBytes) {
  model_.node.emcy.layout = canopen::EmcyLayout::class_and_vendor40;
  model_.faults.drive_texts = {{1, {"OUt1", Severity::fault}}, {2, {"OUt2", Severity::fault}}};
  build();
  Alarm before;
  before.active = true;
  before.errors = {{0x3000, {1}, "OUt1", Severity::fault, WallTime(5s)},
                   {0x3000, {2}, "OUt2", Severity::fault, WallTime(6s)},
                   {0x3000, {3}, "drive fault 3", Severity::fault, WallTime(7s)}};
  alarms_->restore(AlarmKind::emcy, before);
  ASSERT_EQ(emcy_alarm().errors.size(), 3U);
  come_online();
  emcy(0x3000, 0x04, {3});
  ASSERT_EQ(emcy_alarm().errors.size(), 3U);
  EXPECT_EQ(emcy_alarm().errors[2].vendor[0], 3);
  EXPECT_EQ(emcy_alarm().errors[2].since, WallTime(7s)) << "the same error still";
  emcy(0x3000, 0x04, {4});
  EXPECT_EQ(emcy_alarm().errors.size(), 4U);
}

TEST_F(AlarmsTest, ARestoredErrorStaysUndecidedUntilTheErrorRegisterAnswers) {
  Alarm before;
  before.active = true;
  before.errors = {{4, {}, "Overcurrent during acceleration", Severity::fault, WallTime(5s)}};
  alarms_->restore(AlarmKind::emcy, before);
  come_online();
  readings({});
  EXPECT_TRUE(undecided());
  EXPECT_FALSE(emcy_alarm().confirmed);
  reads(0x00);
  EXPECT_FALSE(emcy_alarm().active);
}

TEST_F(AlarmsTest, AFaultCodeRaisesNothingBesideAnErrorWhereTheFaultBitIsClear) {
  model_.node.emcy = {};
  build();
  come_online();
  emcy(0x8130, 0x11);
  fault(false);
  readings({.error_register = std::uint8_t{0x11}, .fault_code = 5, .history = {}});
  EXPECT_EQ(codes(), (Codes{0x8130})) << "a drive may keep the code of a fault that is over";
}

}  // namespace
}  // namespace alarms
