// A stop is never behind anything.

#include <gtest/gtest.h>

#include <optional>
#include <string>
#include <vector>

#include "tests/unit/process/stop_first_bench.h"

namespace process {
namespace {

using namespace std::chrono_literals;

TEST_F(StopFirstTest, BesideAWriteThatTakes700Milliseconds) {
  answer_slow_object(700ms);
  expect_stopped_beside_slow_write(800ms);
}

TEST_F(StopFirstTest, BesideAWriteThatIsNeverAnswered) {
  answer_slow_object(std::nullopt);
  expect_stopped_beside_slow_write(300ms);
}

TEST_F(StopFirstTest, SixtyFourWaitingCommandsDelayNoStop) {
  bring_online();
  show(test::kRunningBit);
  slave_.delay_answers(50ms);
  std::vector<Sent> waiting;
  for (int i = 0; i < 64; ++i) {
    waiting.push_back(write_by(origin(), {field("control_command", Raw{100} + Raw(i))}));
  }
  run(20ms);
  slave_.forget_heard();
  const Sent stop = stop_by(Writer::Way::mqtt);
  EXPECT_LE(until_on_wire(400ms), 60ms);
  EXPECT_TRUE(finish(stop, 200ms).has_value());
  run(1s);
  EXPECT_EQ(slave_.value(test::kControl), kStop);
  ASSERT_TRUE(waiting.front().get().has_value()) << "it had left";
  for (std::size_t i = 1; i < waiting.size(); ++i) {
    expect_refused(waiting[i].get(), ErrorKind::superseded);
  }
}

// A bridge that serves the requests of a connection one by one hands them over late.
TEST_F(StopFirstTest, ARunThatWasReceivedBeforeAStopIsNotSentAfterIt) {
  for (const Writer::Way way : {Writer::Way::modbus, Writer::Way::mqtt, Writer::Way::local}) {
    bring_online();
    const Origin earlier = origin(way);
    run(10ms);
    const Origin stopping = origin(Writer::Way::modbus);
    run(10ms);
    EXPECT_TRUE(finish(write_by(stopping, {field("control_command", kStop)})).has_value());
    slave_.forget_heard();
    const Outcome late = finish(write_by(earlier, {field("control_command", Raw{1})}));
    expect_refused(late, ErrorKind::superseded);
    EXPECT_NE(late.error().detail.find("control_command 5 of modbus 192.0.2.7"), std::string::npos);
    model_.commands.raw = true;
    slave_.set(kSlowObject, DataType::u16, 0);
    expect_refused(
        finish(support::spawn(loop_.executor(), drive_->sdo_write(earlier, {kSlowObject, DataType::u16, 1}))),
        ErrorKind::superseded);
    expect_silence();
    EXPECT_TRUE(finish(write_by(earlier, {field("frequency_command", 10.0)})).has_value()) << "it moves nothing";
    EXPECT_TRUE(finish(write_by(stopping, {field("control_command", Raw{1})})).has_value()) << "of the same moment";
    EXPECT_TRUE(write_now({field("control_command", kStop)}).has_value());
    EXPECT_TRUE(write_now({field("control_command", Raw{1})}).has_value()) << "given after the answer";
    stop();
  }
}

TEST_F(StopFirstTest, OfAStopWhoseMomentIsNotSureTheLatestCounts) {
  bring_online();
  Origin stopping = origin(Writer::Way::modbus);
  run(10ms);
  const Origin between = origin(Writer::Way::mqtt);
  run(10ms);
  stopping.received_until = canopen::Clock::now();
  EXPECT_TRUE(finish(write_by(stopping, {field("control_command", kStop)})).has_value());
  expect_refused(finish(write_by(between, {field("control_command", Raw{1})})), ErrorKind::superseded);
}

TEST_F(StopFirstTest, WhatIsRefusedAsOlderThanAStopTakesNoLease) {
  model_.commands.lease = 10s;
  bring_online();
  const Origin earlier = origin(Writer::Way::mqtt);
  run(10ms);
  EXPECT_TRUE(write_now({field("control_command", kStop)}).has_value());
  run(10s);
  expect_refused(finish(write_by(earlier, {field("control_command", Raw{1})})), ErrorKind::superseded);
  EXPECT_TRUE(write_now({field("control_command", Raw{1})}).has_value());
}

TEST_F(StopFirstTest, GoesWhereASetPointBesideItIsOutOfRangeAndTheLeaseIsForeign) {
  model_.commands.lease = 10s;
  model_.signals[signal("frequency_command")].min = 10.0;
  bring_online();
  run_motor();
  const Outcome outcome =
      finish(write_by(origin(Writer::Way::mqtt), {field("control_command", kStop), field("frequency_command", Raw{0}),
                                                  field("torque_command", Raw{0})}));
  expect_refused(outcome, ErrorKind::lease);
  EXPECT_EQ(outcome.written, 1U);
  EXPECT_NE(outcome.error().detail.find("already written: control_command"), std::string::npos);
  EXPECT_EQ(rpdos(), std::vector<Bytes>({{5, 0, 0xB8, 0x0B, 0, 0}}));
  expect_refused(write_now({field("control_command", Raw{1})}), ErrorKind::lease);
  EXPECT_TRUE(write_now({field("control_command", kStop)}).has_value()) << "he has seen it now";
  EXPECT_TRUE(write_now({field("control_command", Raw{1})}).has_value());
}

TEST_F(StopFirstTest, ASetPointOutOfRangeIsAnsweredAsSuchAndTheStopIsSent) {
  model_.signals[signal("frequency_command")].min = 10.0;
  bring_online();
  run_motor();
  const Outcome outcome = write_now({field("control_command", kStop), field("frequency_command", Raw{0})});
  expect_refused(outcome, ErrorKind::range);
  EXPECT_EQ(rpdos(), std::vector<Bytes>({{5, 0, 0xB8, 0x0B, 0, 0}}));
}

TEST_F(StopFirstTest, IsWrittenToADriveThatIsLeftAlone) {
  slave_.set_state(5);
  model_.node.setup = {{test::kLimit, DataType::u16, 77}};
  start();
  run(3s);
  ASSERT_EQ(drive_->status().boot_result, canopen::BootResult::left_alone);
  slave_.forget_heard();
  EXPECT_TRUE(write_now({field("control_command", kStop), field("frequency_command", 10.0)}).has_error())
      << "its set-points are not sent";
  EXPECT_EQ(sdo_writes(), Objects{test::kControl});
  EXPECT_TRUE(rpdos().empty());
  EXPECT_EQ(slave_.value(test::kControl), kStop);
  expect_refused(write_now({field("control_command", Raw{1})}), ErrorKind::offline);
}

TEST_F(StopFirstTest, IsWrittenToADriveThatBoots) {
  start();
  slave_.delay_answers(30ms);
  slave_.boot_up();
  run(20ms);
  ASSERT_FALSE(drive_->status().configured);
  const Sent stop = stop_by(Writer::Way::modbus);
  EXPECT_LE(until_on_wire(400ms), 150ms);
  EXPECT_TRUE(finish(stop, 200ms).has_value());
  run(6s);
  EXPECT_TRUE(drive_->status().online) << "its boot goes on";
}

TEST_F(StopFirstTest, IsSentOnceToALostDriveAndAnsweredOffline) {
  bring_online();
  slave_.heartbeat_off(true);
  slave_.mute_sdo(true);
  silent_ = true;
  run(3s);
  ASSERT_FALSE(drive_->status().online);
  slave_.forget_heard();
  const Outcome outcome = finish(stop_by(Writer::Way::modbus), 900ms);
  expect_refused(outcome, ErrorKind::offline);
  EXPECT_TRUE(outcome.error().outcome_unknown);
  EXPECT_EQ(sdo_writes(), Objects{test::kControl});
}

TEST_F(StopFirstTest, ADriveThatTakesItByPdoOnlyIsStoppedWithWhatItHolds) {
  bring_online();
  for (const canopen::ObjectAddress object : {test::kControl, test::kFrequency, test::kTorque}) {
    slave_.refuse_write(object, 0x06010002);
  }
  slave_.set(test::kFrequency, DataType::u16, 4000);
  show(test::kRunningBit);
  EXPECT_TRUE(finish(stop_by(Writer::Way::modbus), 100ms).has_value());
  EXPECT_EQ(rpdos(), std::vector<Bytes>({{5, 0, 0xA0, 0x0F, 0, 0}}));
  slave_.forget_heard();
  expect_refused(write_now({field("control_command", Raw{1})}), ErrorKind::incomplete);
  EXPECT_TRUE(rpdos().empty()) << "set-points that nobody commanded complete a stop, and a stop alone";
}

TEST_F(StopFirstTest, TwoStopsAreTwoStops) {
  bring_online();
  show(test::kRunningBit);
  const Sent first = stop_by(Writer::Way::modbus);
  const Sent second = stop_by(Writer::Way::modbus);
  EXPECT_TRUE(finish(first).has_value());
  EXPECT_TRUE(finish(second).has_value());
  EXPECT_EQ(sdo_writes(), (Objects{test::kControl, test::kControl}));
}

TEST_F(StopFirstTest, AnEqualStopThatWaitsIsDoneByTheNewerOne) {
  bring_online();
  slave_.delay_answers(50ms);
  show(test::kRunningBit);
  const Sent first = stop_by(Writer::Way::modbus);
  run(1ms);
  const Sent second = stop_by(Writer::Way::modbus);
  const Sent third = stop_by(Writer::Way::mqtt);
  EXPECT_TRUE(finish(first, 200ms).has_value());
  EXPECT_TRUE(finish(third, 200ms).has_value());
  expect_refused(second.get(), ErrorKind::superseded);
}

TEST_F(StopFirstTest, NothingThatIsRepeatedHoldsARunWordOnceAStopCame) {
  model_.node.rpdos[0].event_timer = std::uint16_t{300};
  bring_online();
  run_motor();
  run(150ms);
  ASSERT_FALSE(rpdos().empty());
  ASSERT_EQ(rpdos().back()[0], 1) << "the run command is repeated";
  slave_.forget_heard();
  const Sent stop = stop_by(Writer::Way::mqtt);
  run(1s);
  ASSERT_TRUE(stop.done());
  ASSERT_GE(rpdos().size(), 9U);
  for (const Bytes& rpdo : rpdos()) {
    EXPECT_EQ(rpdo[0], kStop);
  }
}

TEST_F(StopFirstTest, DoesNotWaitForTheSetPointsOfAnOlderStop) {
  bring_online();
  show(test::kRunningBit);
  slave_.mute(test::kFrequency);
  const Sent older = write_by(origin(), {field("control_command", kStop), field("frequency_command", 10.0)});
  run(30ms);
  slave_.forget_heard();
  const Sent stop = stop_by(Writer::Way::mqtt);
  EXPECT_LE(until_on_wire(400ms), 150ms);
  EXPECT_TRUE(finish(stop, 100ms).has_value());
  EXPECT_TRUE(finish(older, 900ms).has_error());
}

TEST_F(StopFirstTest, LeavesByRpdoWhileAnOlderStopWaitsForItsAnswer) {
  bring_online();
  show(test::kRunningBit);
  slave_.mute(test::kControl);
  const Sent older = stop_by(Writer::Way::modbus);
  run(30ms);
  slave_.forget_heard();
  const Sent stop =
      write_by(origin(Writer::Way::mqtt),
               {field("control_command", kStop), field("frequency_command", 10.0), field("torque_command", 0.0)});
  run(5ms);
  EXPECT_EQ(rpdos(), std::vector<Bytes>({{5, 0, 0xE8, 0x03, 0, 0}}));
  finish(older, 900ms);
  finish(stop, 900ms);
}

TEST_F(StopFirstTest, ADriveThatTakesItByPdoOnlyAndDoesNotTellItsSetPointIsAnsweredInTime) {
  bring_online();
  slave_.refuse_write(test::kControl, 0x06010002);
  slave_.mute(test::kFrequency);
  show(test::kRunningBit);
  expect_refused(finish(stop_by(Writer::Way::modbus), 801ms), ErrorKind::incomplete);
}

TEST_F(StopFirstTest, ARefusalByTheStateOfTheDriveIsTriedByRpdo) {
  bring_online();
  slave_.refuse_write(test::kControl, 0x08000022);
  show(test::kRunningBit);
  EXPECT_TRUE(finish(stop_by(Writer::Way::modbus), 100ms).has_value());
  EXPECT_EQ(rpdos(), std::vector<Bytes>({{5, 0, 0, 0, 0, 0}}));
}

TEST_F(StopFirstTest, TellsWhereTheDriveHeldItAlready) {
  bring_online();
  EXPECT_FALSE(write_now({field("control_command", kStop)}).unchanged);
  EXPECT_TRUE(write_now({field("control_command", kStop)}).unchanged);
}

TEST_F(StopFirstTest, ItsSetPointsAreNotSentOnceTheGatewayEnds) {
  bring_online();
  slave_.delay_answers(20ms);
  const Sent stop = write_by(origin(), {field("control_command", kStop), field("frequency_command", 10.0)});
  run(5ms);
  drive_->close();
  EXPECT_TRUE(finish(stop, 100ms).has_error());
  EXPECT_EQ(sdo_writes(), Objects{test::kControl});
}

TEST_F(StopFirstTest, IsSentByRpdoAgainWhereTheDriveRefusesItBehindAnOlderRun) {
  bring_online();
  show(test::kRunningBit);
  slave_.delay_answers(5s);
  const Sent run_command = write({field("control_command", Raw{1})});
  run(5ms);
  slave_.delay_answers(0ms);
  slave_.refuse_write(test::kControl, 0x08000022);
  const Sent stop =
      write_by(origin(Writer::Way::mqtt),
               {field("control_command", kStop), field("frequency_command", 10.0), field("torque_command", 0.0)});
  EXPECT_TRUE(finish(stop, 300ms).has_value());
  EXPECT_EQ(rpdos(), std::vector<Bytes>({{5, 0, 0xE8, 0x03, 0, 0}, {5, 0, 0xE8, 0x03, 0, 0}}))
      << "the drive may have carried out the run between the first one and its refusal";
  finish(run_command, 900ms);
}

TEST_F(StopFirstTest, TheNewestOfTwoIsTheLastOnTheBus) {
  constexpr Raw kOtherStop = 6;
  model_.node.motor.stops.push_back({.equals = kOtherStop});
  bring_online();
  show(test::kRunningBit);
  slave_.delay_answers(60ms);
  const auto reading = support::spawn(loop_.executor(), drive_->sdo_read(test::kOutput, DataType::u16));
  run(2ms);
  const Sent older = stop_by(Writer::Way::modbus);
  run(2ms);
  const Sent newer =
      write_by(origin(Writer::Way::mqtt),
               {field("control_command", kOtherStop), field("frequency_command", 10.0), field("torque_command", 0.0)});
  run(3ms);
  EXPECT_EQ(rpdos().size(), 1U) << "it does not wait";
  EXPECT_TRUE(finish(newer, 500ms).has_value());
  finish(older, 500ms);
  EXPECT_EQ(slave_.value(test::kControl), kOtherStop);
  ASSERT_FALSE(sdo_writes().empty());
  EXPECT_EQ(sdo_writes().back(), test::kControl);
  EXPECT_TRUE(reading.done());
}

TEST_F(StopFirstTest, SetPointsOfTwoStopsKeepTheirOrder) {
  bring_online();
  show(test::kRunningBit);
  slave_.delay_answers(20ms);
  const Sent slow = write({field("upper_limit", Raw{4000})});
  run(2ms);
  const Sent first = write({field("control_command", kStop), field("frequency_command", 10.0)});
  const Sent second = write({field("control_command", kStop), field("frequency_command", 20.0)});
  EXPECT_TRUE(finish(first, 500ms).has_value());
  EXPECT_TRUE(finish(second, 500ms).has_value());
  EXPECT_EQ(slave_.value(test::kFrequency), 2000U);
  EXPECT_TRUE(slow.done());
}

TEST_F(StopFirstTest, NeedsPermission) {
  model_.commands.writers.mqtt = false;
  bring_online();
  expect_refused(finish(stop_by(Writer::Way::mqtt)), ErrorKind::forbidden);
  EXPECT_TRUE(sdo_writes().empty());
}

TEST_F(StopFirstTest, OneForAllIsTheFirstStopOfTheProfile) {
  bring_online();
  EXPECT_TRUE(finish(support::spawn(loop_.executor(), drive_->stop_motor(origin()))).has_value());
  EXPECT_EQ(slave_.value(test::kControl), kStop);
}

}  // namespace
}  // namespace process
