// Commands: who may, what may be written, by RPDO or SDO, and what is never sent.

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "tests/unit/process/drive_bench.h"

namespace process {
namespace {

using canopen::DataType;
using canopen::ErrorKind;
using canopen::NmtCommand;
using namespace std::chrono_literals;

class CommandsTest : public DriveBench {
 protected:
  void expect_refused(const Outcome& outcome, ErrorKind kind) {
    ASSERT_TRUE(outcome.has_error());
    EXPECT_EQ(outcome.error().kind, kind) << canopen::to_string(outcome.error());
  }
  /// Nothing that commands was sent: no RPDO, no SDO download, no NMT.
  void expect_silence() {
    EXPECT_TRUE(rpdos().empty());
    EXPECT_TRUE(sdo_writes().empty());
    EXPECT_TRUE(slave_.heard_on(0).empty());
  }
  /// A single set-point goes to its own object, and no RPDO with an earlier run command leaves.
  void expect_setpoint_goes_alone() {
    slave_.forget_heard();
    EXPECT_TRUE(write_now({field("frequency_command", 20.0)}).has_value());
    EXPECT_TRUE(rpdos().empty());
    EXPECT_EQ(sdo_writes(), Objects{test::kFrequency});
    EXPECT_EQ(slave_.value(test::kFrequency), 2000U);
  }
  void expect_setpoint_rides_on_rpdo() {
    slave_.forget_heard();
    EXPECT_TRUE(write_now({field("frequency_command", 20.0)}).has_value());
    EXPECT_EQ(rpdos(), std::vector<Bytes>({{1, 0, 0xD0, 0x07, 0, 0}}));
    EXPECT_TRUE(sdo_writes().empty());
  }
};

// Who may.

TEST_F(CommandsTest, EachWayNeedsItsPermission) {
  model_.commands.writers = {.modbus = false, .mqtt = true, .local = false};
  bring_online();
  expect_refused(write_now({field("frequency_command", 10.0)}), ErrorKind::forbidden);
  expect_refused(nmt_now(NmtCommand::start), ErrorKind::forbidden);
  expect_refused(sdo_write_now({{0x2002, 3}, DataType::u16, 1}), ErrorKind::forbidden);
  expect_silence();
  const auto by_mqtt =
      support::spawn(loop_.executor(), drive_->write(writer(Writer::Way::mqtt), {field("frequency_command", 10.0)}));
  EXPECT_TRUE(finish(by_mqtt).has_value());
  const auto by_local =
      support::spawn(loop_.executor(), drive_->write(writer(Writer::Way::local), {field("frequency_command", 10.0)}));
  expect_refused(finish(by_local), ErrorKind::forbidden);
}

TEST_F(CommandsTest, ChecksComeInTheirOrder) {
  model_.commands.writers = {};
  slave_.unplug(true);
  start();  // Offline, so everything is wrong at once.
  expect_refused(write_now({field("output_frequency", 99.0)}), ErrorKind::forbidden);
  model_.commands.writers.modbus = true;
  expect_refused(write_now({field("output_frequency", 99.0)}), ErrorKind::read_only);
  expect_refused(write_now({field("frequency_command", 99.0)}), ErrorKind::range);
  expect_refused(write_now({field("frequency_command", 10.0)}), ErrorKind::offline);
  expect_silence();
}

// What may be written.

TEST_F(CommandsTest, OutOfRangeIsRefusedNeverClamped) {
  bring_online();
  const Outcome outcome = write_now({field("frequency_command", 50.004)});
  expect_refused(outcome, ErrorKind::range);
  EXPECT_EQ(outcome.error().detail, "out of range 0..50");
  EXPECT_EQ(outcome.error().object, test::kFrequency);
  expect_refused(write_now({field("frequency_command", Raw{5001})}), ErrorKind::range);
  expect_silence();
  EXPECT_TRUE(write_now({field("frequency_command", 50.0)}).has_value());
}

TEST_F(CommandsTest, SeveralFieldsAreCheckedBeforeAnythingIsSent) {
  bring_online();
  const Outcome outcome = write_now({field("frequency_command", 10.0), field("torque_command", 1e9)});
  expect_refused(outcome, ErrorKind::range);
  EXPECT_EQ(outcome.error().detail, "torque_command: out of range -3276.8..3276.7");
  expect_silence();
}

TEST_F(CommandsTest, ReadOnlyDerivedAndUnknownSignalsAreRefused) {
  bring_online();
  expect_refused(write_now({field("output_frequency", 1.0)}), ErrorKind::read_only);
  expect_refused(write_now({field("running", 1.0)}), ErrorKind::read_only);
  expect_refused(write_now({{9999, 1.0}}), ErrorKind::unknown);
  expect_refused(write_now({}), ErrorKind::unknown);
  expect_silence();
}

// Reachable.

TEST_F(CommandsTest, NothingIsQueuedForADriveThatIsNotThere) {
  start();
  const auto offline = write({field("frequency_command", 10.0)});
  loop_.settle();
  ASSERT_TRUE(offline.done()) << "refused at once";
  expect_refused(offline.get(), ErrorKind::offline);
  slave_.boot_up();
  run(3s);
  ASSERT_TRUE(drive_->status().online);
  EXPECT_TRUE(rpdos().empty());
  EXPECT_EQ(std::ranges::count(sdo_writes(), test::kFrequency), 0);
}

TEST_F(CommandsTest, NotOperationalIsRefusedAtOnce) {
  bring_online();
  slave_.set_state(127);
  run(600ms);
  ASSERT_EQ(drive_->status().nmt, canopen::NmtState::pre_operational);
  slave_.forget_heard();
  const auto refused = write({field("frequency_command", 10.0)});
  loop_.settle();
  ASSERT_TRUE(refused.done());
  expect_refused(refused.get(), ErrorKind::offline);
  EXPECT_EQ(refused.get().error().detail, "the drive is pre-operational, not operational");
  expect_silence();
}

// RPDO or SDO.

TEST_F(CommandsTest, SingleWriteGoesToItsObjectUntilEveryFieldWasCommanded) {
  bring_online();
  ASSERT_TRUE(write_now({field("frequency_command", 10.0)}).has_value());
  ASSERT_TRUE(write_now({field("torque_command", 5.0)}).has_value());
  EXPECT_TRUE(rpdos().empty());
  ASSERT_TRUE(write_now({field("control_command", Raw{1})}).has_value());
  // The third completed it.
  EXPECT_EQ(rpdos(), std::vector<Bytes>({{1, 0, 0xE8, 0x03, 50, 0}}));
  EXPECT_EQ(sdo_writes(), (Objects{test::kFrequency, test::kTorque}));
}

TEST_F(CommandsTest, FieldsWrittenTogetherCompleteAnRpdo) {
  bring_online();
  ASSERT_TRUE(write_all(1, 30.0, -1.0).has_value());
  EXPECT_EQ(rpdos(), std::vector<Bytes>({{1, 0, 0xB8, 0x0B, 0xF6, 0xFF}}));
  EXPECT_TRUE(sdo_writes().empty());
}

TEST_F(CommandsTest, ConfirmedValuesAreShownAndTold) {
  bring_online();
  EXPECT_EQ(drive_->image().commanded(signal("frequency_command")), 0U);
  ASSERT_TRUE(write_all(1, 30.0).has_value());
  EXPECT_EQ(drive_->image().commanded(signal("frequency_command")), 3000U);
  EXPECT_EQ(drive_->image().commanded(signal("control_command")), 1U);
  ASSERT_EQ(observer_.commanded.size(), 1U);
  EXPECT_EQ(observer_.commanded[0],
            (std::vector<SignalId>{signal("control_command"), signal("frequency_command"), signal("torque_command")}));
}

TEST_F(CommandsTest, RefusedWriteChangesNoCommandedValue) {
  bring_online();
  slave_.refuse_write(test::kFrequency, 0x08000022);
  const Outcome outcome = write_now({field("frequency_command", 10.0)});
  expect_refused(outcome, ErrorKind::refused);
  EXPECT_EQ(outcome.error().abort, 0x08000022U);
  EXPECT_EQ(drive_->image().commanded(signal("frequency_command")), 0U);
  EXPECT_TRUE(observer_.commanded.empty());
}

TEST_F(CommandsTest, SetPointsFirstAndControlCommandLast) {
  bring_online();
  ASSERT_TRUE(
      write_now({field("control_command", Raw{1}), field("upper_limit", Raw{4000}), field("frequency_command", 10.0)})
          .has_value());
  EXPECT_EQ(sdo_writes(), (Objects{test::kLimit, test::kFrequency, test::kControl}));
  EXPECT_TRUE(rpdos().empty());
}

TEST_F(CommandsTest, RpdoWithTheControlCommandComesAfterOtherSetPoints) {
  bring_online();
  ASSERT_TRUE(write_now({field("control_command", Raw{1}), field("frequency_command", 10.0),
                         field("torque_command", 0.0), field("upper_limit", Raw{4000})})
                  .has_value());
  EXPECT_EQ(sdo_writes(), Objects{test::kLimit});
  ASSERT_EQ(rpdos().size(), 1U);
  const auto& heard = slave_.heard();
  const auto rpdo = std::ranges::find_if(heard, [](const auto& frame) { return frame.id == kRpdo1; });
  const auto sdo = std::ranges::find_if(
      heard, [](const auto& frame) { return frame.id == 0x605 && (frame.data[0] & 0xE0U) == 0x20; });
  EXPECT_LT(sdo - heard.begin(), rpdo - heard.begin());
}

TEST_F(CommandsTest, StopsAtTheFirstFailureAndNamesWhatWasWritten) {
  bring_online();
  slave_.refuse_write(test::kFrequency, 0x06090031);
  const Outcome outcome =
      write_now({field("control_command", Raw{1}), field("upper_limit", Raw{4000}), field("frequency_command", 10.0)});
  expect_refused(outcome, ErrorKind::refused);
  EXPECT_EQ(outcome.error().abort, 0x06090031U);
  EXPECT_NE(outcome.error().detail.find("already written: upper_limit"), std::string::npos);
  EXPECT_EQ(sdo_writes(), (Objects{test::kLimit, test::kFrequency}));
  EXPECT_EQ(drive_->image().commanded(signal("upper_limit")), 4000U);
  EXPECT_EQ(drive_->image().commanded(signal("control_command")), 0U);
}

TEST_F(CommandsTest, TheLastOfTwoValuesForOneSignalCounts) {
  bring_online();
  ASSERT_TRUE(write_now({field("frequency_command", 10.0), field("frequency_command", 20.0)}).has_value());
  EXPECT_EQ(sdo_writes(), Objects{test::kFrequency});
  EXPECT_EQ(slave_.value(test::kFrequency), 2000U);
}

TEST_F(CommandsTest, ObjectThatTakesNoSdoMakesAnIncompleteRpdoIncomplete) {
  bring_online();
  slave_.refuse_write(test::kFrequency, 0x06020000);
  const Outcome outcome = write_now({field("frequency_command", 10.0)});
  expect_refused(outcome, ErrorKind::incomplete);
  EXPECT_EQ(outcome.error().abort, 0x06020000U);
  EXPECT_NE(outcome.error().detail.find("write control_command, frequency_command and torque_command together"),
            std::string::npos)
      << outcome.error().detail;
  EXPECT_TRUE(write_all(1, 10.0).has_value());
}

TEST_F(CommandsTest, RpdoWithAnUnnamedFieldIsNeverSent) {
  model_.node.rpdos[0].mapping[2].use = canopen::FieldUse::unnamed;
  std::erase_if(model_.signals, [](const config::Signal& each) { return each.name == "torque_command"; });
  model_.faults.running = model_.find("running");
  model_.faults.fault = model_.find("fault");
  model_.faults.warning = model_.find("warning");
  bring_online();
  ASSERT_TRUE(write_now({field("control_command", Raw{1}), field("frequency_command", 10.0)}).has_value());
  EXPECT_TRUE(rpdos().empty());
  EXPECT_EQ(sdo_writes(), (Objects{test::kFrequency, test::kControl}));
}

TEST_F(CommandsTest, UnusedFieldIsSentAsZero) {
  model_.node.rpdos[0].mapping[2].use = canopen::FieldUse::unused;
  std::erase_if(model_.signals, [](const config::Signal& each) { return each.name == "torque_command"; });
  model_.faults.running = model_.find("running");
  model_.faults.fault = model_.find("fault");
  model_.faults.warning = model_.find("warning");
  bring_online();
  ASSERT_TRUE(write_now({field("control_command", Raw{1}), field("frequency_command", 10.0)}).has_value());
  EXPECT_EQ(rpdos(), std::vector<Bytes>({{1, 0, 0xE8, 0x03, 0, 0}}));
}

// A set-point never carries a run command that nobody gave since.

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
  static_cast<void>(support::spawn(loop_.executor(), drive_->nmt(writer(), NmtCommand::start)));
  run(4s);
  ASSERT_EQ(drive_->status().nmt, canopen::NmtState::operational);
  EXPECT_TRUE(rpdos().empty());
  expect_setpoint_goes_alone();
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

TEST_F(CommandsTest, CommandGivenBeforeAFaultAndSentAfterItIsNotKept) {
  bring_online();
  show(test::kRunningBit);
  slave_.delay_answers(100ms);
  const auto first = write({field("upper_limit", Raw{4000})});
  const auto second =
      write({field("control_command", Raw{1}), field("frequency_command", 10.0), field("torque_command", 0.0)});
  run(20ms);
  emcy(0x0004, 0x01);
  ASSERT_TRUE(finish(first, 300ms).has_value());
  ASSERT_TRUE(finish(second, 300ms).has_value());
  slave_.delay_answers(0ms);
  expect_setpoint_goes_alone();
}

// Order and deadline.

TEST_F(CommandsTest, CommandsOfOneDriveLeaveInOrderOfArrival) {
  bring_online();
  slave_.delay_answers(30ms);
  const auto first = write({field("frequency_command", 10.0)});
  const auto second = write({field("upper_limit", Raw{4000})});
  const auto third = write({field("frequency_command", 20.0)});
  run(200ms);
  EXPECT_TRUE(first.done() && second.done() && third.done());
  EXPECT_EQ(sdo_writes(), (Objects{test::kFrequency, test::kLimit, test::kFrequency}));
  EXPECT_EQ(slave_.value(test::kFrequency), 2000U);
}

TEST_F(CommandsTest, CommandNotBegunByItsDeadlineIsWithdrawn) {
  model_.node.sdo.timeout = 2s;  // the first command holds the channel beyond the deadline of both
  bring_online();
  slave_.mute(test::kLimit);
  const auto stuck = write({field("upper_limit", Raw{4000})});
  const auto late = write({field("frequency_command", 10.0)});
  run(801ms);
  ASSERT_TRUE(stuck.done());
  ASSERT_TRUE(late.done());
  expect_refused(stuck.get(), ErrorKind::timeout);
  EXPECT_TRUE(stuck.get().error().outcome_unknown);
  expect_refused(late.get(), ErrorKind::timeout);
  EXPECT_FALSE(late.get().error().outcome_unknown);
  run(5s);
  EXPECT_EQ(std::ranges::count(sdo_writes(), test::kFrequency), 0);
}

TEST_F(CommandsTest, UnconfirmedWriteIsAnsweredUnknownAndNeverRepeated) {
  bring_online();
  slave_.mute(test::kFrequency);
  const auto sent = write({field("frequency_command", 10.0)});
  run(801ms);
  ASSERT_TRUE(sent.done()) << "answered at the latest after the deadline";
  expect_refused(sent.get(), ErrorKind::timeout);
  EXPECT_TRUE(sent.get().error().outcome_unknown);
  EXPECT_EQ(drive_->image().commanded(signal("frequency_command")), 0U);
  run(10s);
  EXPECT_EQ(std::ranges::count(sdo_writes(), test::kFrequency), 1);
}

TEST_F(CommandsTest, RebootFailsWhatIsPendingAndWhatWaits) {
  bring_online();
  model_.commands.deadline = 5s;
  slave_.delay_answers(200ms);
  const auto first = write({field("frequency_command", 10.0)});
  const auto second = write({field("frequency_command", 20.0)});
  run(50ms);
  slave_.boot_up();
  slave_.delay_answers(0ms);
  loop_.settle();
  ASSERT_TRUE(first.done());
  run(3s);
  ASSERT_TRUE(second.done());
  EXPECT_TRUE(first.get().has_error());
  expect_refused(second.get(), ErrorKind::offline);
  EXPECT_EQ(std::ranges::count(sdo_writes(), test::kFrequency), 1);
}

TEST_F(CommandsTest, StopAnswersPendingCommandsOffline) {
  bring_online();
  slave_.mute(test::kFrequency);
  const auto first = write({field("frequency_command", 10.0)});
  const auto second = write({field("upper_limit", Raw{1})});
  run(50ms);
  stop();
  ASSERT_TRUE(first.done());
  ASSERT_TRUE(second.done());
  expect_refused(first.get(), ErrorKind::offline);
  expect_refused(second.get(), ErrorKind::offline);
}

// NMT.

TEST_F(CommandsTest, NmtThatStopsIsForbiddenWhileTheMotorRuns) {
  bring_online();
  run_motor();
  for (const NmtCommand command :
       {NmtCommand::stop, NmtCommand::pre_operational, NmtCommand::reset_node, NmtCommand::reset_communication}) {
    expect_refused(nmt_now(command), ErrorKind::forbidden);
  }
  expect_silence();
  show(0);
  EXPECT_TRUE(nmt_now(NmtCommand::pre_operational).has_value());
  EXPECT_EQ(slave_.heard_on(0).size(), 1U);
}

TEST_F(CommandsTest, NmtThatStopsIsForbiddenWhileNobodyKnowsWhetherItRuns) {
  bring_online();
  silent_ = true;
  slave_.mute(test::kStatusWord);
  run(2s);
  ASSERT_FALSE(fresh("running"));
  slave_.forget_heard();
  expect_refused(nmt_now(NmtCommand::reset_node), ErrorKind::forbidden);
  expect_silence();
  model_.commands.nmt_while_running = true;
  EXPECT_TRUE(nmt_now(NmtCommand::reset_node).has_value());
}

TEST_F(CommandsTest, NmtBehindARunCommandSeesTheMotorRun) {
  bring_online();
  slave_.delay_answers(100ms);
  const auto run_command = write({field("control_command", Raw{1})});
  const auto stop_node = support::spawn(loop_.executor(), drive_->nmt(writer(), NmtCommand::stop));
  run(50ms);
  show(test::kRunningBit);
  ASSERT_TRUE(finish(run_command, 300ms).has_value());
  expect_refused(finish(stop_node, 300ms), ErrorKind::forbidden);
}

TEST_F(CommandsTest, NmtStartIsAllowedAnyTime) {
  bring_online();
  run_motor();
  EXPECT_TRUE(nmt_now(NmtCommand::start).has_value());
}

// SDO requests.

TEST_F(CommandsTest, SdoWriteOfASignalsObjectGoesTheSignalsWay) {
  bring_online();
  expect_refused(sdo_write_now({test::kFrequency, DataType::u16, 5001}), ErrorKind::range);
  expect_refused(sdo_write_now({test::kFrequency, DataType::u32, 1000}), ErrorKind::type);
  expect_silence();
  EXPECT_TRUE(sdo_write_now({test::kFrequency, DataType::u16, 1000}).has_value());
  EXPECT_EQ(drive_->image().commanded(signal("frequency_command")), 1000U);
  run_motor();
  EXPECT_TRUE(sdo_write_now({test::kFrequency, DataType::u16, 2000}).has_value());
  EXPECT_EQ(rpdos(), std::vector<Bytes>({{1, 0, 0xD0, 0x07, 0, 0}}));
}

TEST_F(CommandsTest, OtherObjectsNeedRaw) {
  slave_.set({0x2002, 3}, DataType::u16, 0);
  slave_.set({0x1400, 1}, DataType::u32, 0);
  bring_online();
  expect_refused(sdo_write_now({{0x2002, 3}, DataType::u16, 3}), ErrorKind::forbidden);
  expect_silence();
  model_.commands.raw = true;
  EXPECT_TRUE(sdo_write_now({{0x2002, 3}, DataType::u16, 3}).has_value());
  EXPECT_EQ(slave_.value({0x2002, 3}), 3U);
  slave_.forget_heard();
  for (const auto index : std::vector<std::uint16_t>{0x1400, 0x1600, 0x1800, 0x1A00}) {
    expect_refused(sdo_write_now({{index, 1}, DataType::u32, 0x80000205}), ErrorKind::forbidden);
  }
  expect_silence();
}

TEST_F(CommandsTest, SdoReadNeedsNoPermission) {
  model_.commands.writers = {};
  slave_.set({0x2002, 3}, DataType::u16, 1234);
  bring_online();
  const auto read = support::spawn(loop_.executor(), drive_->sdo_read({0x2002, 3}, DataType::u16));
  run(10ms);
  ASSERT_TRUE(read.done());
  EXPECT_EQ(read.get().value(), 1234U);
}

}  // namespace
}  // namespace process
