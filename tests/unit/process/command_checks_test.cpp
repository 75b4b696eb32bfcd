// Who may command what: permissions, access, type, range, reachability, NMT, SDO requests.

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "tests/unit/process/commands_fixture.h"

namespace process {
namespace {

using namespace std::chrono_literals;

TEST_F(CommandsTest, EachWayNeedsItsPermission) {
  model_.commands.writers = {.modbus = false, .mqtt = true, .local = false};
  bring_online();
  expect_refused(write_now({field("frequency_command", 10.0)}), ErrorKind::forbidden);
  expect_refused(nmt_now(NmtCommand::start), ErrorKind::forbidden);
  expect_refused(sdo_write_now({{0x2002, 3}, DataType::u16, 1}), ErrorKind::forbidden);
  expect_silence();
  const auto by_mqtt =
      support::spawn(loop_.executor(), drive_->write(origin(Writer::Way::mqtt), {field("frequency_command", 10.0)}));
  EXPECT_TRUE(finish(by_mqtt).has_value());
  const auto by_local =
      support::spawn(loop_.executor(), drive_->write(origin(Writer::Way::local), {field("frequency_command", 10.0)}));
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
  const auto stop_node = support::spawn(loop_.executor(), drive_->nmt(origin(), NmtCommand::stop));
  run(50ms);
  show(test::kRunningBit);
  ASSERT_TRUE(finish(run_command, 300ms).has_value());
  expect_refused(finish(stop_node, 300ms), ErrorKind::forbidden);
}

TEST_F(CommandsTest, WhatSaidThatTheMotorStandsBeforeARunCommandSaysNothingAfterIt) {
  bring_online();
  ASSERT_TRUE(write_all(1, 30.0).has_value());
  expect_refused(nmt_now(NmtCommand::stop), ErrorKind::forbidden);
  show(0);  // It was told to run, and does not.
  EXPECT_TRUE(nmt_now(NmtCommand::stop).has_value());
}

TEST_F(CommandsTest, ADriveThatWasLeftAloneIsAskedWhetherItsMotorRuns) {
  model_.node.setup = {{test::kLimit, DataType::u16, 7}};  // It runs, and holds another value.
  model_.node.motor.running =
      canopen::MotorSign{test::kStatusWord, DataType::u16, test::kRunningBit, {test::kRunningBit}};
  slave_.set_state(5);
  status_word_ = test::kRunningBit;
  send_tpdos();
  start();
  run(2500ms);
  ASSERT_EQ(drive_->status().boot_result, canopen::BootResult::left_alone) << drive_->status().boot_text;
  slave_.forget_heard();
  const Outcome while_running = nmt_now(NmtCommand::pre_operational);
  expect_refused(while_running, ErrorKind::forbidden);
  EXPECT_NE(while_running.error().detail.find("the motor runs"), std::string::npos) << while_running.error().detail;
  expect_silence();
  show(0);
  EXPECT_TRUE(nmt_now(NmtCommand::pre_operational).has_value());
  EXPECT_EQ(slave_.state(), 127U);
  slave_.forget_heard();
  slave_.set_state(5);
  run(1s);
  slave_.remove(test::kStatusWord);
  silent_ = true;
  expect_refused(nmt_now(NmtCommand::stop), ErrorKind::forbidden);
  EXPECT_TRUE(slave_.heard_on(0).empty());
}

TEST_F(CommandsTest, NmtStartIsAllowedAnyTime) {
  bring_online();
  run_motor();
  EXPECT_TRUE(nmt_now(NmtCommand::start).has_value());
}

TEST_F(CommandsTest, SdoWriteOfASignalsObjectGoesTheSignalsWay) {
  bring_online();
  expect_refused(sdo_write_now({test::kFrequency, DataType::u16, 5001}), ErrorKind::range);
  expect_refused(sdo_write_now({test::kFrequency, DataType::u32, 1000}), ErrorKind::type);
  expect_silence();
  EXPECT_TRUE(sdo_write_now({test::kFrequency, DataType::u16, 1000}).has_value());
  EXPECT_EQ(drive_->commanded().shown(signal("frequency_command")), 1000U);
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

TEST_F(CommandsTest, BytesOfASignalsObjectGoTheSignalsWayToo) {
  bring_online();
  run_motor();
  EXPECT_TRUE(sdo_write_now(test::kFrequency, {0xD0, 0x07}).has_value());
  EXPECT_EQ(rpdos(), std::vector<Bytes>({{1, 0, 0xD0, 0x07, 0, 0}}));
  slave_.forget_heard();
  expect_refused(sdo_write_now(test::kFrequency, {0x89, 0x13}), ErrorKind::range);
  for (const Bytes& other : std::vector<Bytes>{{1}, {1, 0, 0}, {1, 0, 0, 0}, Bytes(20, 1)}) {
    expect_refused(sdo_write_now(test::kFrequency, other), ErrorKind::type);
  }
  expect_silence();
}

TEST_F(CommandsTest, BytesOfAnyOtherObjectNeedRaw) {
  const Bytes text(20, 'a');
  slave_.set_bytes({0x2002, 4}, Bytes(20, 'b'));
  slave_.set_bytes({0x2002, 5}, Bytes(3, 0));
  bring_online();
  expect_refused(sdo_write_now({0x2002, 4}, text), ErrorKind::forbidden);
  model_.commands.raw = true;
  expect_refused(sdo_write_now({0x1A00, 1}, text), ErrorKind::forbidden);
  expect_silence();
  EXPECT_TRUE(sdo_write_now({0x2002, 4}, text).has_value());
  EXPECT_TRUE(sdo_write_now({0x2002, 5}, {1, 2, 3}).has_value());
  EXPECT_EQ(slave_.value({0x2002, 5}), 0x030201U);
  const auto& [record, outcome] = observer_.answers.back();
  EXPECT_EQ(record.kind, CommandRecord::Kind::raw);
  EXPECT_EQ(record.bytes, Bytes({1, 2, 3}));
  ASSERT_TRUE(record.object);
  EXPECT_EQ(record.object->object, (canopen::ObjectAddress{0x2002, 5}));

  const auto read = support::spawn(loop_.executor(), drive_->sdo_read({0x2002, 4}));
  run(10ms);
  ASSERT_TRUE(read.done());
  EXPECT_EQ(read.get().value(), text);
  slave_.refuse_write({0x2002, 4}, 0x06070010);
  const Outcome refused = sdo_write_now({0x2002, 4}, text);
  ASSERT_TRUE(refused.has_error());
  EXPECT_EQ(refused.error().abort, 0x06070010U);
  EXPECT_EQ(drive_->last_refused_abort(), 0x06070010U);
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

TEST_F(CommandsTest, APartOfAnObjectIsNotShownAsItsValue) {
  slave_.set({0x2002, 3}, DataType::u16, 0x0150);
  slave_.set_bytes({0x1008, 0}, {'V', 'F', 'D', '-', '3', '0', '0'});
  bring_online();
  const auto kind_of = [&](canopen::ObjectAddress object, DataType type) {
    const auto read = support::spawn(loop_.executor(), drive_->sdo_read(object, type));
    run(50ms);
    return read.done() && read.get().has_error() ? std::optional(read.get().error().kind) : std::nullopt;
  };
  EXPECT_EQ(kind_of({0x2002, 3}, DataType::i8), ErrorKind::type);
  EXPECT_EQ(kind_of({0x2002, 3}, DataType::u32), ErrorKind::type);
  EXPECT_EQ(kind_of({0x1008, 0}, DataType::u16), ErrorKind::type);
  // Four bytes for a small value, as some drives answer, are that value.
  slave_.set_bytes({0x2002, 3}, {0xF4, 0x01, 0x00, 0x00});
  EXPECT_EQ(kind_of({0x2002, 3}, DataType::u16), std::nullopt);
  slave_.set_bytes({0x2002, 3}, {0xFE, 0xFF, 0xFF, 0xFF});
  EXPECT_EQ(kind_of({0x2002, 3}, DataType::i16), std::nullopt);
  EXPECT_EQ(kind_of({0x2002, 3}, DataType::u16), ErrorKind::type);
}

TEST_F(CommandsTest, WhatWasAskedIsKeptWhateverWasWrongWithIt) {
  bring_online();
  expect_refused(write_now({field("frequency_command", 50.5)}), ErrorKind::range);
  EXPECT_EQ(observer_.answers.back().first.fields.at(0).asked, 5050U);
  expect_refused(write_now({field("frequency_command", 7e5)}), ErrorKind::range);
  EXPECT_EQ(observer_.answers.back().first.fields.at(0).asked, std::nullopt);
  EXPECT_EQ(observer_.answers.back().first.fields.at(0).given, 7e5);
}

}  // namespace
}  // namespace process
