// A set-point never carries a run command that nobody gave since fault, standstill, loss, boot-up or start.

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "tests/unit/process/commands_fixture.h"

namespace process {
namespace {

constexpr canopen::Raw kQuickStopBit = 0x80;

using namespace std::chrono_literals;

TEST_F(CommandsTest, SetPointRidesOnTheRpdoWhileTheMotorRuns) {
  bring_online();
  run_motor();
  expect_setpoint_rides_on_rpdo();
}

TEST_F(CommandsTest, NothingCommandedAfterTheGatewaysStart) {
  bring_online();
  run(5s);
  EXPECT_TRUE(rpdos().empty());
  expect_setpoint_goes_alone();
}

TEST_F(CommandsTest, TakenOverDriveGetsNothingUnasked) {
  slave_.set_state(5);
  status_word_ = test::kRunningBit;
  start();
  run(3s);
  ASSERT_TRUE(drive_->status().online);
  EXPECT_EQ(drive_->image().raw(signal("running")), 1U);
  expect_silence();
  expect_setpoint_goes_alone();
}

TEST_F(CommandsTest, BootUpMakesEarlierCommandsVoid) {
  bring_online();
  run_motor();
  slave_.boot_up();
  show(0);
  run(3s);
  ASSERT_TRUE(drive_->status().online);
  EXPECT_TRUE(rpdos().empty());
  expect_setpoint_goes_alone();
}

TEST_F(CommandsTest, LossMakesEarlierCommandsVoid) {
  bring_online();
  run_motor();
  slave_.unplug(true);
  run(2s);
  ASSERT_FALSE(drive_->status().online);
  slave_.unplug(false);
  run(5s);
  ASSERT_TRUE(drive_->status().online);
  EXPECT_TRUE(rpdos().empty());
  expect_setpoint_goes_alone();
}

TEST_F(CommandsTest, BusFailureMakesEarlierCommandsVoid) {
  bring_online();
  run_motor();
  wire_.set_state({canopen::BusCondition::bus_off, 255, 0});
  run(100ms);
  ASSERT_FALSE(drive_->status().online);
  wire_.set_state({canopen::BusCondition::error_active, 0, 0});
  run(5s);
  ASSERT_TRUE(drive_->status().online);
  EXPECT_TRUE(rpdos().empty());
  expect_setpoint_goes_alone();
}

TEST_F(CommandsTest, FaultBitMakesEarlierCommandsVoid) {
  bring_online();
  run_motor();
  show(test::kRunningBit | test::kFaultBit);
  expect_setpoint_goes_alone();
}

TEST_F(CommandsTest, EmergencyOfAFaultMakesEarlierCommandsVoid) {
  bring_online();
  run_motor();
  emcy(0x0004, 0x01);
  expect_setpoint_goes_alone();
}

TEST_F(CommandsTest, EmergencyOfAWarningDoesNot) {
  bring_online();
  run_motor();
  emcy(0x0040, 0x01);
  expect_setpoint_rides_on_rpdo();
}

TEST_F(CommandsTest, TheEndOfAWarningLeavesASupervisedMotorRunning) {
  model_.node.rpdos[0].event_timer = std::uint16_t{300};
  bring_online();
  run_motor();
  emcy(0x0040, 0x01);
  emcy(0x0000, 0x00);
  run(1s);
  EXPECT_GE(rpdos().size(), 9U) << "it would trip";
}

TEST_F(CommandsTest, WhatWasCommandedDuringAFaultIsVoidAfterIt) {
  bring_online();
  show(test::kFaultBit);
  ASSERT_TRUE(write_all(1, 30.0).has_value());  // Pressed start, nothing happened.
  show(0);                                      // Reset at the drive's panel.
  expect_setpoint_goes_alone();
}

TEST_F(CommandsTest, StandstillMakesEarlierCommandsVoid) {
  bring_online();
  run_motor();
  show(0);
  expect_setpoint_goes_alone();
}

TEST_F(CommandsTest, StatusThatIsNotFreshMakesEarlierCommandsVoid) {
  bring_online();
  run_motor();
  silent_ = true;
  run(310ms);
  silent_ = false;
  run(100ms);
  ASSERT_TRUE(fresh("running"));
  expect_setpoint_goes_alone();
}

TEST_F(CommandsTest, WhileNobodyKnowsWhetherItRunsNothingIsKept) {
  bring_online();
  silent_ = true;
  slave_.mute(test::kStatusWord);
  run(2s);
  ASSERT_FALSE(fresh("running"));
  ASSERT_TRUE(write_all(1, 30.0).has_value());
  expect_setpoint_goes_alone();
}

TEST_F(CommandsTest, LeavingOperationalMakesEarlierCommandsVoid) {
  bring_online();
  run_motor();
  slave_.set_state(127);
  run(600ms);
  ASSERT_EQ(drive_->status().nmt, canopen::NmtState::pre_operational);
  static_cast<void>(support::spawn(loop_.executor(), drive_->nmt(origin(), NmtCommand::start)));
  run(4s);
  ASSERT_EQ(drive_->status().nmt, canopen::NmtState::operational);
  EXPECT_TRUE(rpdos().empty());
  expect_setpoint_goes_alone();
}

TEST_F(CommandsTest, NmtCommandsBetweenTwoHeartbeatsMakeEarlierCommandsVoid) {
  for (const NmtCommand leave : {NmtCommand::pre_operational, NmtCommand::stop}) {
    bring_online();
    model_.commands.nmt_while_running = true;
    run_motor();
    ASSERT_TRUE(nmt_now(leave).has_value());
    EXPECT_FALSE(fresh("running")) << "it sends no TPDO now";
    EXPECT_FALSE(alarm(alarms::AlarmKind::data).active);
    ASSERT_TRUE(nmt_now(NmtCommand::start).has_value());
    show(test::kRunningBit);
    expect_setpoint_goes_alone();
    stop();
  }
}

TEST_F(CommandsTest, NothingIsTakenForADriveThatWasJustMadePreOperational) {
  bring_online();
  ASSERT_TRUE(nmt_now(NmtCommand::pre_operational).has_value());
  slave_.forget_heard();
  const Outcome outcome = write_now({field("frequency_command", 10.0)});
  ASSERT_TRUE(outcome.has_error());
  EXPECT_EQ(outcome.error().kind, canopen::ErrorKind::offline);
  EXPECT_NE(outcome.error().detail.find("pre-operational"), std::string::npos) << outcome.error().detail;
}

TEST_F(CommandsTest, CommandsWhileStandingKeepCountingUntilTheMotorStopped) {
  bring_online();
  ASSERT_TRUE(write_all(1, 30.0).has_value());
  run(250ms);  // Not turning yet: no standstill, it never ran.
  show(test::kRunningBit);
  expect_setpoint_rides_on_rpdo();
}

TEST_F(CommandsTest, MomentaryValueIsForgottenOnceSent) {
  bring_online();
  ASSERT_TRUE(write_all(7, 30.0).has_value());
  EXPECT_EQ(rpdos(), std::vector<Bytes>({{7, 0, 0xB8, 0x0B, 0, 0}}));
  expect_setpoint_goes_alone();
}

TEST_F(CommandsTest, MomentaryValueBySdoReplacesWhatWasKnown) {
  bring_online();
  run_motor();
  ASSERT_TRUE(write_now({field("control_command", Raw{7})}).has_value());
  expect_setpoint_goes_alone();
}

TEST_F(CommandsTest, FieldOfUnknownOutcomeCountsAsNotCommanded) {
  bring_online();
  run_motor();
  wire_.withhold_echoes(true);
  const Outcome outcome = finish(write({field("control_command", Raw{1})}), 900ms);
  expect_refused(outcome, ErrorKind::timeout);
  EXPECT_TRUE(outcome.error().outcome_unknown);
  wire_.withhold_echoes(false);
  run(500ms);
  slave_.forget_heard();
  // The bus takes commands again after an echo, which the gateway's own reads bring.
  ASSERT_TRUE(write_now({field("frequency_command", 20.0)}).has_value());
  EXPECT_TRUE(rpdos().empty());
}

TEST_F(CommandsTest, FaultWhileAnSdoWriteIsUnderWayDoesNotReviveKnowledge) {
  bring_online();
  ASSERT_TRUE(write_now({field("frequency_command", 10.0)}).has_value());
  ASSERT_TRUE(write_now({field("torque_command", 0.0)}).has_value());
  show(test::kRunningBit);
  slave_.delay_answers(50ms);
  slave_.forget_heard();
  // By SDO since the running bit has come; then a fault while it is under way.
  show(0);
  const auto control = write({field("control_command", Raw{1})});
  run(10ms);
  emcy(0x0004, 0x01);
  ASSERT_TRUE(finish(control, 200ms).has_value());
  slave_.delay_answers(0ms);
  slave_.forget_heard();
  ASSERT_TRUE(write_now({field("frequency_command", 11.0), field("torque_command", 0.0)}).has_value());
  EXPECT_TRUE(rpdos().empty()) << "the run command was given before the fault";
}

TEST_F(CommandsTest, CommandGivenBeforeAFaultIsNotSentAfterIt) {
  bring_online();
  run_command_waits_while_a_fault_comes();
  expect_setpoint_goes_alone();
}

TEST_F(CommandsTest, AnUncommandedStandstillIsRepeatedAsAStop) {
  // The drive supervises this RPDO, so it is repeated.
  model_.node.rpdos[0].event_timer = std::uint16_t{300};
  bring_online();
  run_motor();
  show(0);  // Stopped at the drive's keypad.
  slave_.forget_heard();
  run(350ms);
  ASSERT_GE(rpdos().size(), 3U) << "it would trip";
  show(test::kRunningBit);  // Started at the keypad; then back to remote.
  run(350ms);
  for (const Bytes& rpdo : rpdos()) {
    EXPECT_EQ(rpdo, (Bytes{5, 0, 0xB8, 0x0B, 0, 0})) << "nobody commanded a start since";
  }
}

TEST_F(CommandsTest, WithoutAKnownStopAnUncommandedStandstillEndsTheRepetition) {
  model_.node.motor.stops.clear();
  model_.node.rpdos[0].event_timer = std::uint16_t{300};
  bring_online();
  run_motor();
  show(0);
  slave_.forget_heard();
  run(2s);
  EXPECT_TRUE(rpdos().empty());
}

TEST_F(CommandsTest, RepetitionDoesNotBringBackWhatAnSdoWriteIsJustChanging) {
  model_.node.rpdos[0].event_timer = std::uint16_t{300};
  bring_online();
  run_motor();
  show(0);  // Standstill: the control command does not count, but the RPDO goes on with a stop.
  slave_.forget_heard();
  run(150ms);
  ASSERT_FALSE(rpdos().empty());
  slave_.delay_answers(80ms);
  slave_.forget_heard();
  const auto slower = write({field("frequency_command", 10.0)});
  run(75ms);
  EXPECT_TRUE(rpdos().empty()) << "still with the frequency of before";
  ASSERT_TRUE(finish(slower, 20ms).has_value());
  slave_.forget_heard();
  run(250ms);
  ASSERT_FALSE(rpdos().empty());
  EXPECT_EQ(rpdos().front(), (Bytes{5, 0, 0xE8, 0x03, 0, 0}));
}

TEST_F(CommandsTest, QuickStopMakesEarlierCommandsVoidAndEndsTheirRepetition) {
  model_.signals.push_back(test::bit("quick_stop_active", 0, kQuickStopBit));
  model_.faults.quick_stop = model_.find("quick_stop_active");
  model_.node.rpdos[0].event_timer = std::uint16_t{300};
  bring_online();
  ASSERT_TRUE(write_all(0x0F, 30.0).has_value());  // Enable operation.
  show(test::kRunningBit);
  show(kQuickStopBit);
  slave_.forget_heard();
  run(2s);
  EXPECT_TRUE(rpdos().empty()) << "repeating the run command would end the quick stop";
  expect_setpoint_goes_alone();
}

TEST_F(CommandsTest, ACommandedQuickStopGoesOnBeingRepeated) {
  model_.node.motor.stops = {{.mask = 0xF884, .equals = 0}};
  model_.signals.push_back(test::bit("quick_stop_active", 0, kQuickStopBit));
  model_.faults.quick_stop = model_.find("quick_stop_active");
  model_.node.rpdos[0].event_timer = std::uint16_t{300};
  bring_online();
  run_motor();
  ASSERT_TRUE(write_all(0x02, 30.0).has_value());
  show(kQuickStopBit);
  slave_.forget_heard();
  run(1s);
  EXPECT_GE(rpdos().size(), 9U) << "a drive that supervises it would trip, and perhaps coast";
  EXPECT_EQ(rpdos().back()[0], 0x02);
}

TEST_F(CommandsTest, ARowOfSdoWritesHoldsBackOneRepetitionAtMost) {
  model_.node.rpdos[0].event_timer = std::uint16_t{300};
  bring_online();
  run_motor();
  show(0);
  slave_.delay_answers(60ms);
  slave_.forget_heard();
  for (int i = 0; i < 10; ++i) {
    const auto setting = write({field("frequency_command", 10.0 + i)});
    ASSERT_TRUE(finish(setting, 200ms).has_value());
  }
  EXPECT_GE(rpdos().size(), 3U) << "it trips after 300 ms of silence";
}

TEST_F(CommandsTest, WhatWasConfirmedAfterTheDriveLeftOperationalDoesNotCount) {
  bring_online();
  show(0);
  slave_.delay_answers(50ms);
  const auto control = write({field("control_command", Raw{1})});
  run(10ms);
  slave_.set_state(127);
  slave_.send(0x705, {127});
  ASSERT_TRUE(finish(control, 100ms).has_value()) << "it had left already";
  EXPECT_FALSE(drive_->commanded().counts(signal("control_command")));
  EXPECT_EQ(drive_->commanded().shown(signal("control_command")), 1U);
}

TEST_F(CommandsTest, WhatHasAnUnknownOutcomeDoesNotCount) {
  bring_online();
  run_motor();
  slave_.delay_answers(5s);
  show(0);
  const auto control = write({field("frequency_command", 10.0)});
  ASSERT_TRUE(finish(control, 900ms).has_error());
  ASSERT_TRUE(control.get().error().outcome_unknown);
  EXPECT_FALSE(drive_->commanded().counts(signal("frequency_command")));
  EXPECT_TRUE(drive_->commanded().doubtful_at(signal("frequency_command")));
}

// One of two faults has gone (CiA 301: the error register is not 0), then the other one.
TEST_F(CommandsTest, ARunCommandedBetweenTheEndsOfTwoFaultsIsVoidAfterTheSecond) {
  bring_online();
  run_motor();
  emcy(0x0004, 0x05);
  emcy(0x0005, 0x05);
  emcy(0x0000, 0x04);
  EXPECT_TRUE(write_all(1, 30.0).has_value());
  emcy(0x0000, 0x00);
  EXPECT_FALSE(drive_->commanded().counts(signal("control_command")));
}

}  // namespace
}  // namespace process
