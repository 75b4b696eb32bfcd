// The order of commands to one drive: newest wins for set-points, time that is left, what is looked at again.

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/unit/process/commands_fixture.h"

namespace process {
namespace {

using namespace std::chrono_literals;

class NewestWinsTest : public CommandsTest {
 protected:
  using Sent = support::Spawned<Outcome>;

  Sent write_by(const Origin& from, std::vector<FieldWrite> fields) {
    return support::spawn(loop_.executor(), drive_->write(from, std::move(fields)));
  }
  /// Something is under way for `time`.
  void begin_slow(Duration time) {
    bring_online();
    slave_.delay_answers(time);
    slow_.emplace(write({field("upper_limit", Raw{4000})}));
    run(5ms);
  }
  Sent set(double frequency, Writer::Way way = Writer::Way::modbus) {
    return write_by(origin(way), {field("frequency_command", frequency)});
  }

  std::optional<Sent> slow_;
};

TEST_F(NewestWinsTest, AWaitingSetPointIsSupersededByALaterOneOfItsWriter) {
  begin_slow(50ms);
  const Sent first = set(10.0);
  const Sent second = set(20.0);
  loop_.settle();
  ASSERT_TRUE(first.done()) << "answered at once";
  expect_refused(first.get(), ErrorKind::superseded);
  EXPECT_TRUE(finish(second, 200ms).has_value());
  EXPECT_EQ(slave_.value(test::kFrequency), 2000U);
  EXPECT_EQ(sdo_writes(), (Objects{test::kLimit, test::kFrequency}));
}

TEST_F(NewestWinsTest, NotByAnotherWriter) {
  begin_slow(50ms);
  const Sent first = set(10.0);
  const Sent second = set(20.0, Writer::Way::mqtt);
  EXPECT_TRUE(finish(first, 200ms).has_value());
  EXPECT_TRUE(finish(second, 200ms).has_value());
}

TEST_F(NewestWinsTest, NotByOneThatWritesLess) {
  begin_slow(50ms);
  const Sent first = write({field("frequency_command", 10.0), field("torque_command", 1.0)});
  const Sent second = set(20.0);
  EXPECT_TRUE(finish(first, 400ms).has_value());
  EXPECT_TRUE(finish(second, 200ms).has_value());
}

TEST_F(NewestWinsTest, NotByOneThatIsRefused) {
  begin_slow(50ms);
  model_.signals[signal("frequency_command")].max = 50.0;
  const Sent first = set(10.0);
  expect_refused(finish(set(60.0)), ErrorKind::range);
  EXPECT_TRUE(finish(first, 200ms).has_value());
}

TEST_F(NewestWinsTest, WhatWasSupersededIsNotBroughtBackWhereTheLaterOneFails) {
  begin_slow(50ms);
  const Sent first = set(10.0);
  slave_.refuse_write(test::kFrequency, 0x06090032);
  const Sent second = set(20.0);
  expect_refused(finish(second, 200ms), ErrorKind::refused);
  expect_refused(first.get(), ErrorKind::superseded);
  run(500ms);
  EXPECT_EQ(sdo_writes(), (Objects{test::kLimit, test::kFrequency}));
}

TEST_F(NewestWinsTest, ControlCommandsKeepTheirOrder) {
  begin_slow(20ms);
  std::vector<Sent> steps;
  for (const Raw word : {Raw{6}, Raw{7}, Raw{15}}) {
    steps.push_back(write({field("control_command", word)}));
  }
  for (const Sent& step : steps) {
    EXPECT_TRUE(finish(step, 200ms).has_value());
  }
  EXPECT_EQ(sdo_writes(), (Objects{test::kLimit, test::kControl, test::kControl, test::kControl}));
  EXPECT_EQ(slave_.value(test::kControl), 15U);
}

TEST_F(NewestWinsTest, OneThatHasTooLittleTimeLeftIsNotBegunAndSaysHowLongItWaited) {
  bring_online();
  slave_.delay_answers(200ms);
  ASSERT_TRUE(finish(write({field("torque_command", 1.0)}), 300ms).has_value()) << "it takes 200 ms";
  slave_.forget_heard();
  slave_.delay_answers(700ms);
  const Sent slow = write({field("upper_limit", Raw{4000})});
  const Sent late = set(10.0, Writer::Way::mqtt);
  const Outcome outcome = finish(late, 800ms);
  expect_refused(outcome, ErrorKind::timeout);
  EXPECT_FALSE(outcome.error().outcome_unknown);
  EXPECT_NE(outcome.error().detail.find("not begun after 70"), std::string::npos) << outcome.error().detail;
  EXPECT_TRUE(finish(slow, 100ms).has_value()) << "the deadline holds, not the timeout of one answer";
  EXPECT_EQ(sdo_writes(), Objects{test::kLimit});
}

TEST_F(NewestWinsTest, ExpiryIsLookedAtAgainAtItsTurn) {
  begin_slow(300ms);
  Origin from = origin(Writer::Way::mqtt);
  from.expires = canopen::Clock::now() + 200ms;
  const Sent expiring = write_by(from, {field("frequency_command", 10.0)});
  expect_refused(finish(expiring, 400ms), ErrorKind::expired);
  EXPECT_EQ(sdo_writes(), Objects{test::kLimit});
}

TEST_F(NewestWinsTest, TheDeadlineCountsFromWhenItWasReceived) {
  bring_online();
  Origin from = origin(Writer::Way::mqtt);
  from.received = canopen::Clock::now() - 900ms;
  expect_refused(finish(write_by(from, {field("frequency_command", 10.0)})), ErrorKind::timeout);
  EXPECT_TRUE(sdo_writes().empty());
}

TEST_F(NewestWinsTest, TellsWhereTheDriveHeldItAlready) {
  bring_online();
  EXPECT_FALSE(write_now({field("frequency_command", 10.0)}).unchanged);
  EXPECT_TRUE(write_now({field("frequency_command", 10.0)}).unchanged);
  EXPECT_FALSE(write_now({field("frequency_command", 11.0)}).unchanged);
  ASSERT_TRUE(write_now({field("control_command", Raw{7})}).has_value());
  EXPECT_TRUE(write_now({field("control_command", Raw{7})}).unchanged) << "an edge that it shows already does nothing";
}

TEST_F(NewestWinsTest, ARunCommandThatWaitsWhileAQuickStopComesIsRefused) {
  model_.signals.push_back(test::bit("quick_stop_active", 0, 0x80));
  model_.faults.quick_stop = model_.find("quick_stop_active");
  begin_slow(100ms);
  const Sent run_command = write({field("control_command", Raw{1})});
  run(10ms);
  show(0x80);
  expect_refused(finish(run_command, 300ms), ErrorKind::voided);
  EXPECT_EQ(sdo_writes(), Objects{test::kLimit});
}

TEST_F(NewestWinsTest, SetPointsOutliveFaultAndStandstill) {
  bring_online();
  run_motor();
  emcy(0x0004, 0x01);
  show(0);
  EXPECT_TRUE(drive_->commanded().counts(signal("frequency_command")));
  EXPECT_FALSE(drive_->commanded().counts(signal("control_command")));
  ASSERT_TRUE(write_now({field("control_command", Raw{1})}).has_value());
  EXPECT_EQ(rpdos(), std::vector<Bytes>({{1, 0, 0xB8, 0x0B, 0, 0}})) << "a new run command completes the RPDO";
}

TEST_F(NewestWinsTest, AFaultOfASupervisedDriveIsResetAndItRunsAgain) {
  model_.node.rpdos[0].event_timer = std::uint16_t{300};
  model_.signals[signal("control_command")].edge = {7};
  bring_online();
  run_motor();
  show(test::kFaultBit);
  slave_.forget_heard();
  run(500ms);
  EXPECT_TRUE(rpdos().empty()) << "nothing of before the fault";
  ASSERT_TRUE(write_now({field("control_command", Raw{7})}).has_value());
  show(0);
  run(1s);
  EXPECT_GE(rpdos().size(), 9U) << "it would trip again";
  EXPECT_EQ(rpdos().back()[0], 7);
  slave_.forget_heard();
  ASSERT_TRUE(write_now({field("control_command", Raw{1})}).has_value());
  run(200ms);
  ASSERT_FALSE(rpdos().empty());
  EXPECT_EQ(rpdos().back(), (Bytes{1, 0, 0xB8, 0x0B, 0, 0}));
}

TEST_F(NewestWinsTest, ALevelTriggeredResetIsNotRepeated) {
  model_.node.rpdos[0].event_timer = std::uint16_t{300};
  bring_online();
  run_motor();
  show(test::kFaultBit);
  ASSERT_TRUE(write_now({field("control_command", Raw{7})}).has_value());
  slave_.forget_heard();
  run(1s);
  EXPECT_TRUE(rpdos().empty()) << "it would reset the next fault, too";
}

TEST_F(NewestWinsTest, AReadableSignalIsReadBackAtOnceAndShowsWhatWasWrittenUntilThen) {
  bring_online();
  slave_.ignore_write(test::kLimit);
  const Raw before = slave_.value(test::kLimit);
  ASSERT_TRUE(write_now({field("upper_limit", Raw{4000})}).has_value());
  run(50ms);
  EXPECT_EQ(drive_->image().raw(signal("upper_limit")), before);
  ASSERT_FALSE(observer_.remarks.empty());
  EXPECT_NE(observer_.remarks.back().find("upper_limit was written and confirmed as 4000"), std::string::npos);
}

// A waiting set-point of the same writer is older than that beside his stop.
TEST_F(NewestWinsTest, ASetPointBesideAStopIsNotReplacedByAnOlderOne) {
  bring_online();
  show(test::kRunningBit);
  slave_.delay_answers(20ms);
  const Sent slow = write({field("upper_limit", Raw{4000})});
  run(2ms);
  const Sent older = write({field("frequency_command", 50.0)});
  run(1ms);
  const Sent stop =
      write({field("control_command", Raw{5}), field("frequency_command", 10.0), field("torque_command", 0.0)});
  EXPECT_TRUE(finish(stop, 500ms).has_value());
  run(200ms);
  ASSERT_TRUE(older.done());
  EXPECT_TRUE(older.get().has_error()) << "written whole by a later command of its writer";
  EXPECT_EQ(drive_->commanded().shown(signal("frequency_command")), 1000U);
  finish(slow, 100ms);
}

TEST_F(NewestWinsTest, ASetPointThatIsLeftOutOfAStopReplacesNone) {
  bring_online();
  show(test::kRunningBit);
  slave_.delay_answers(20ms);
  const Sent slow = write({field("upper_limit", Raw{4000})});
  run(2ms);
  const Sent older = write({field("frequency_command", 20.0)});
  run(1ms);
  const Sent stop = write({field("control_command", Raw{5}), field("frequency_command", 9999.0)});
  expect_refused(finish(stop, 500ms), ErrorKind::range);
  EXPECT_TRUE(finish(older, 500ms).has_value());
  EXPECT_EQ(slave_.value(test::kFrequency), 2000U);
  finish(slow, 100ms);
}

}  // namespace
}  // namespace process
