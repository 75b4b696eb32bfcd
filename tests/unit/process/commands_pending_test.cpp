// What becomes of commands that wait or are under way at their deadline, a boot-up, and the end.

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "tests/unit/process/commands_fixture.h"

namespace process {
namespace {

using namespace std::chrono_literals;

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
  EXPECT_FALSE(drive_->commanded().counts(signal("frequency_command")));
  run(10s);
  EXPECT_EQ(std::ranges::count(sdo_writes(), test::kFrequency), 1);
}

// Whoever wants to replace the drive asks for it: its motor may start any moment.
TEST_F(CommandsTest, ARunCommandOfUnknownOutcomeMayBeObeyedUntilTheMotorWasSeenToStand) {
  bring_online();
  ASSERT_EQ(drive_->turning(), Turning::no);
  slave_.mute(test::kControl);
  const auto sent = write({field("control_command", Raw{1})});
  run(801ms);
  ASSERT_TRUE(sent.done());
  ASSERT_TRUE(sent.get().has_error());
  EXPECT_TRUE(sent.get().error().outcome_unknown);
  EXPECT_EQ(drive_->turning(), Turning::yes);
  run(500ms);
  EXPECT_EQ(drive_->turning(), Turning::yes) << "it has hardly begun";
  run(800ms);
  EXPECT_EQ(drive_->turning(), Turning::no);
}

TEST_F(CommandsTest, AMomentaryCommandMayMakeTheMotorTurnSoon) {
  model_.signals[signal("control_command")].momentary = {3, 7};
  bring_online();
  ASSERT_TRUE(write_now({field("control_command", Raw{3})}).has_value());
  EXPECT_EQ(drive_->turning(), Turning::yes);
  run(1200ms);
  EXPECT_EQ(drive_->turning(), Turning::no);
  ASSERT_TRUE(write_now({field("control_command", Raw{5})}).has_value());
  EXPECT_EQ(drive_->turning(), Turning::no) << "a stop moves nothing";
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
  EXPECT_TRUE(second.get().has_error());
  EXPECT_EQ(std::ranges::count(sdo_writes(), test::kFrequency), 1);
}

TEST_F(CommandsTest, AStopBetweenTwoStepsOfARunCommandSupersedesTheSecond) {
  bring_online();
  slave_.delay_answers(50ms);
  const auto started = write({field("control_command", Raw{1}), field("frequency_command", 10.0)});
  run(20ms);
  const auto stopped = write({field("control_command", Raw{5})});
  EXPECT_TRUE(finish(stopped, 300ms).has_value());
  ASSERT_TRUE(started.done());
  expect_refused(started.get(), ErrorKind::superseded);
  EXPECT_NE(started.get().error().detail.find("frequency_command"), std::string::npos) << started.get().error().detail;
  run(1s);
  EXPECT_EQ(sdo_writes(), (Objects{test::kFrequency, test::kControl}));
  EXPECT_EQ(slave_.value(test::kControl), 5U);
}

TEST_F(CommandsTest, TheEndAnswersPendingCommandsOffline) {
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

}  // namespace
}  // namespace process
