// Lease, timeout and feedback as the drive and its bus see them.

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "tests/unit/process/commands_fixture.h"

namespace process {
namespace {

using namespace std::chrono_literals;

class CommandsControlTest : public CommandsTest {
 protected:
  void set_timeout(config::OnTimeout on_timeout) {
    model_.commands.timeout = 2s;
    model_.commands.on_timeout = on_timeout;
    if (on_timeout == config::OnTimeout::values) {
      model_.commands.timeout_values = {{.signal = signal("control_command"), .raw = 5}};
    }
  }
  Outcome write_by(Writer::Way way, std::vector<FieldWrite> fields) {
    return finish(support::spawn(loop_.executor(), drive_->write(origin(way), std::move(fields))));
  }
  [[nodiscard]] bool timed_out() const { return drive_->control().timeout; }
  /// What of `control_command` was written by SDO.
  [[nodiscard]] std::ptrdiff_t control_writes() const { return std::ranges::count(sdo_writes(), test::kControl); }
  /// The timeout has acted, its value by SDO is not answered.
  void let_values_fail() {
    set_timeout(config::OnTimeout::values);
    bring_online();
    ASSERT_TRUE(write_now({field("control_command", Raw{1})}).has_value());
    show(test::kRunningBit);
    slave_.mute(test::kControl);
    slave_.forget_heard();
    run(2100ms);
    ASSERT_TRUE(timed_out());
  }
};

TEST_F(CommandsControlTest, HoldShowsAndSendsNothing) {
  set_timeout(config::OnTimeout::hold);
  bring_online();
  run_motor();
  run(1900ms);
  EXPECT_FALSE(timed_out());
  run(200ms);
  EXPECT_TRUE(timed_out());
  EXPECT_TRUE(alarm(alarms::AlarmKind::control).active);
  EXPECT_TRUE(rpdos().empty());
  EXPECT_TRUE(sdo_writes().empty());
  EXPECT_TRUE(write_all(1, 30.0).has_value());
  EXPECT_FALSE(timed_out());
  EXPECT_FALSE(alarm(alarms::AlarmKind::control).active);
}

TEST_F(CommandsControlTest, CeaseEndsTheRepetitionUntilTheNextCommand) {
  set_timeout(config::OnTimeout::cease);
  model_.node.rpdos[0].event_timer = std::uint16_t{300};
  bring_online();
  run_motor();
  run(1900ms);
  EXPECT_GE(rpdos().size(), 15U);
  run(200ms);
  EXPECT_TRUE(timed_out());
  slave_.forget_heard();
  run(2s);
  EXPECT_TRUE(rpdos().empty()) << "the drive trips";
  EXPECT_TRUE(sdo_writes().empty());
  EXPECT_TRUE(write_all(1, 30.0).has_value());
  run(350ms);
  EXPECT_GE(rpdos().size(), 3U);
}

TEST_F(CommandsControlTest, ASignOfLifeKeepsItAway) {
  set_timeout(config::OnTimeout::hold);
  bring_online();
  run_motor();
  for (int i = 0; i < 4; ++i) {
    run(1500ms);
    drive_->sign_of_life(origin().writer);
  }
  EXPECT_FALSE(timed_out());
  run(1500ms);
  drive_->sign_of_life(origin(Writer::Way::mqtt).writer);
  run(600ms);
  EXPECT_TRUE(timed_out()) << "that of another does not";
}

TEST_F(CommandsControlTest, ValuesStopTheMotorByTheRpdoThatIsComplete) {
  set_timeout(config::OnTimeout::values);
  bring_online();
  run_motor();
  run(2100ms);
  EXPECT_EQ(rpdos(), std::vector<Bytes>({{5, 0, 0xB8, 0x0B, 0, 0}}));
  EXPECT_TRUE(timed_out());
  slave_.forget_heard();
  run(5s);
  EXPECT_TRUE(rpdos().empty()) << "once confirmed, not again";
  EXPECT_TRUE(alarm(alarms::AlarmKind::control).active) << "until a command ends it";
}

TEST_F(CommandsControlTest, ValuesPassAForeignLeaseAndWhatWaits) {
  set_timeout(config::OnTimeout::values);
  model_.commands.lease = 1min;
  bring_online();
  run_motor();
  run(1800ms);
  slave_.delay_answers(700ms);
  const auto slow = write({field("upper_limit", Raw{4000})});  // a sign of life: 2 s more
  run(800ms);
  ASSERT_TRUE(slow.done());
  slave_.forget_heard();
  run(1300ms);
  EXPECT_EQ(rpdos(), std::vector<Bytes>({{5, 0, 0xB8, 0x0B, 0, 0}}));
}

TEST_F(CommandsControlTest, ValuesAreRepeatedEachSecondUntilACommandIsAccepted) {
  let_values_fail();
  EXPECT_GE(control_writes(), 1);
  run(3s);
  const auto attempts = control_writes();
  EXPECT_GE(attempts, 3);
  EXPECT_LE(attempts, 8) << "each is a stop, which may be sent twice";
  ASSERT_TRUE(drive_->control().alarm);
  EXPECT_EQ(drive_->control().alarm->reason, alarms::ControlReason::timeout_failed);
  const auto stopped = write({field("control_command", Raw{5})});
  run(900ms);
  ASSERT_TRUE(stopped.done());
  EXPECT_FALSE(timed_out());
  slave_.forget_heard();
  run(1s);
  EXPECT_EQ(control_writes(), 0);
  run(200ms);
  EXPECT_TRUE(timed_out()) << "that stop was not confirmed either, and who gave it has been silent since";
}

TEST_F(CommandsControlTest, ADriveThatWasLostAndComesBackGetsNoValues) {
  let_values_fail();
  slave_.unplug(true);
  run(2s);
  ASSERT_FALSE(drive_->status().online);
  slave_.unplug(false);
  slave_.forget_heard();
  run(10s);
  ASSERT_TRUE(drive_->status().online);
  EXPECT_TRUE(rpdos().empty());
  EXPECT_EQ(control_writes(), 0);
  EXPECT_TRUE(alarm(alarms::AlarmKind::control).active) << "the alarm stays";
  EXPECT_TRUE(timed_out());
}

TEST_F(CommandsControlTest, ADriveThatIsTakenOverAsItRunsNeedsASignOfLifeOfAnyWriter) {
  set_timeout(config::OnTimeout::values);
  slave_.set_state(5);
  status_word_ = test::kRunningBit;
  start();
  ASSERT_TRUE(loop_.advance_until([this] { return drive_->status().online; }, 5s));
  slave_.forget_heard();
  for (int i = 0; i < 3; ++i) {
    run(1500ms);
    drive_->sign_of_life(origin(i % 2 == 0 ? Writer::Way::modbus : Writer::Way::mqtt).writer);
  }
  EXPECT_FALSE(timed_out());
  EXPECT_TRUE(sdo_writes().empty());
  run(2100ms);
  EXPECT_TRUE(timed_out());
  EXPECT_EQ(sdo_writes(), Objects{test::kControl});
  EXPECT_EQ(slave_.value(test::kControl), 5U);
}

TEST_F(CommandsControlTest, ALeaseKeepsOthersAwayButNoStop) {
  model_.commands.lease = 10s;
  bring_online();
  ASSERT_TRUE(write_by(Writer::Way::modbus, {field("frequency_command", 10.0)}).has_value());
  for (const auto way : {Writer::Way::mqtt, Writer::Way::local}) {
    expect_refused(write_by(way, {field("frequency_command", 20.0)}), ErrorKind::lease);
    EXPECT_TRUE(write_by(way, {field("control_command", Raw{5})}).has_value());
    EXPECT_EQ(drive_->control().holder, origin().writer);
  }
  expect_refused(write_by(Writer::Way::modbus, {field("control_command", Raw{1})}), ErrorKind::lease);
  EXPECT_TRUE(write_by(Writer::Way::modbus, {field("control_command", Raw{5})}).has_value());
  EXPECT_TRUE(write_by(Writer::Way::modbus, {field("control_command", Raw{1})}).has_value());
  run(10100ms);
  EXPECT_FALSE(drive_->control().holder);
  EXPECT_TRUE(write_by(Writer::Way::local, {field("frequency_command", 20.0)}).has_value());
}

TEST_F(CommandsControlTest, WhoHasNotTheLeaseLearnsThatBeforeAnythingOfBitsThatAreNotKnown) {
  model_.commands.lease = 10s;
  bring_online();
  ASSERT_TRUE(write_by(Writer::Way::modbus, {field("frequency_command", 10.0)}).has_value());
  const FieldWrite bits{signal("control_command"), Mask{.and_mask = 0xFFFE, .or_mask = 0}};
  expect_refused(write_by(Writer::Way::mqtt, {bits}), ErrorKind::lease);
  expect_refused(write_by(Writer::Way::modbus, {bits}), ErrorKind::incomplete);
}

TEST_F(CommandsControlTest, AMotorThatDoesNotFollowIsAnAlarm) {
  model_.commands.feedback = 1s;
  bring_online();
  ASSERT_TRUE(write_all(1, 30.0).has_value());
  run(900ms);
  EXPECT_FALSE(alarm(alarms::AlarmKind::control).active);
  run(200ms);
  EXPECT_TRUE(alarm(alarms::AlarmKind::control).active);
  show(test::kRunningBit);
  EXPECT_FALSE(alarm(alarms::AlarmKind::control).active);
}

}  // namespace
}  // namespace process
