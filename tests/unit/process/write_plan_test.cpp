// By RPDO or SDO, in which order, and what is known afterwards.

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "tests/unit/process/commands_fixture.h"

namespace process {
namespace {

using namespace std::chrono_literals;

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
  EXPECT_EQ(drive_->commanded().shown(signal("frequency_command")), 0U);
  ASSERT_TRUE(write_all(1, 30.0).has_value());
  EXPECT_EQ(drive_->commanded().shown(signal("frequency_command")), 3000U);
  EXPECT_EQ(drive_->commanded().shown(signal("control_command")), 1U);
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
  EXPECT_EQ(drive_->commanded().shown(signal("frequency_command")), 0U);
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
  EXPECT_EQ(drive_->commanded().shown(signal("upper_limit")), 4000U);
  EXPECT_EQ(drive_->commanded().shown(signal("control_command")), 0U);
}

TEST_F(CommandsTest, WhatABridgeRefusedByItselfDoesNotCountAsAFailedWrite) {
  bring_online();
  slave_.refuse_write(test::kFrequency, 0x06090031);
  ASSERT_TRUE(write_now({field("upper_limit", Raw{4000}), field("frequency_command", 10.0)}).has_error());
  ASSERT_EQ(drive_->last_written(), 1U);
  (void)drive_->refuse(origin(), CommandRecord::Kind::write, {.kind = ErrorKind::read_only});
  EXPECT_EQ(drive_->last_written(), 1U);
  ASSERT_TRUE(write_now({field("frequency_command", 10.0)}).has_error());
  EXPECT_EQ(drive_->last_written(), 0U);
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

}  // namespace
}  // namespace process
