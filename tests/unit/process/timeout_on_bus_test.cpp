// Timeouts, leases and feedback as the bus sees them.

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "tests/unit/process/commands_fixture.h"

namespace process {
namespace {

using namespace std::chrono_literals;

constexpr canopen::Raw kStopWord = 5;
constexpr canopen::Duration kTimeout = 500ms;

/// Holder, timeout and alarm in the order in which they were told.
class ControlObserver final : public Observer {
 public:
  void on_values(const Drive& /*drive*/, std::span<const SignalId> /*signals*/) override {}
  void on_freshness(const Drive& /*drive*/, std::span<const SignalId> /*signals*/) override {}
  void on_commanded(const Drive& /*drive*/, std::span<const SignalId> /*signals*/) override {}
  void on_status(const Drive& /*drive*/) override {}
  void on_alarm(const Drive& /*drive*/, alarms::AlarmKind /*kind*/) override {}
  void on_bus(std::size_t /*bus*/) override {}
  void on_control(const Drive& drive) override { told.push_back(drive.control()); }

  std::vector<ControlState> told;
};

class TimeoutOnBusTest : public CommandsTest {
 protected:
  TimeoutOnBusTest() { observers_.push_back(&control_); }

  void act_by(config::OnTimeout action) {
    model_.commands.timeout = kTimeout;
    model_.commands.on_timeout = action;
  }
  void write_on_timeout(std::string_view name, Raw raw) {
    act_by(config::OnTimeout::values);
    model_.commands.timeout_values.push_back({.signal = signal(name), .raw = raw});
  }
  support::Spawned<Outcome> write_by(const Writer& writer, std::vector<FieldWrite> fields) {
    return support::spawn(loop_.executor(), drive_->write({.writer = writer}, std::move(fields)));
  }
  /// `control_command` alone was commanded, so that it goes by SDO, and the motor turns.
  void run_motor_by_sdo() {
    ASSERT_TRUE(write_now({field("control_command", Raw{1})}).has_value());
    show(test::kRunningBit);
    slave_.forget_heard();
  }
  /// SDO requests for `control_command` are not answered while `mute_control_`.
  void mute_control() {
    mute_control_ = true;
    slave_.script([this](const Bytes& request) {
      const bool control = request[1] == 0x30 && request[2] == 0x20 && request[3] == 0x02;
      return mute_control_ && control ? std::optional(std::vector<Bytes>{}) : std::nullopt;
    });
  }
  void make_drive_unreachable(bool unreachable) {
    slave_.heartbeat_off(unreachable);
    slave_.mute_sdo(unreachable);
    silent_ = unreachable;
  }
  /// A drive is found that runs already.
  void take_over_running() {
    slave_.set_state(5);
    status_word_ = test::kRunningBit;
    start();
    for (int ms = 0; ms < 5000 && !drive_->status().online; ++ms) {
      run(1ms);
    }
    ASSERT_TRUE(drive_->status().online) << drive_->status().boot_text;
    slave_.forget_heard();
  }
  void expect_alarm(std::string_view text) {
    const alarms::Alarm& shown = alarm(alarms::AlarmKind::control);
    EXPECT_TRUE(shown.active);
    ASSERT_EQ(shown.errors.size(), 1U);
    EXPECT_NE(shown.text.find(text), std::string::npos) << shown.text;
    EXPECT_TRUE(drive_->control().timeout);
  }
  void expect_no_alarm() {
    EXPECT_FALSE(alarm(alarms::AlarmKind::control).active) << alarm(alarms::AlarmKind::control).text;
    EXPECT_FALSE(drive_->control().timeout);
  }

  ControlObserver control_;
  bool mute_control_ = false;
  const Writer plc_{.way = Writer::Way::modbus, .address = "192.0.2.7"};
  const Writer panel_{.way = Writer::Way::modbus, .address = "192.0.2.8"};
  const Writer mqtt_{.way = Writer::Way::mqtt, .address = {}};
  const Writer local_{.way = Writer::Way::local, .address = {}};
};

TEST_F(TimeoutOnBusTest, HoldSendsNothingAndTells) {
  act_by(config::OnTimeout::hold);
  bring_online();
  run_motor();
  run(kTimeout - 30ms);
  expect_no_alarm();
  observer_.alarms.clear();  // That there was none became known at its arrival.
  run(60ms);
  expect_alarm("no sign of life of modbus 192.0.2.7");
  EXPECT_EQ(std::count(observer_.alarms.begin(), observer_.alarms.end(), alarms::AlarmKind::control), 1);
  ASSERT_FALSE(control_.told.empty());
  EXPECT_TRUE(control_.told.back().timeout);
  run(2s);
  expect_silence();
  drive_->sign_of_life(plc_);
  ASSERT_TRUE(write_now({field("frequency_command", 20.0)}).has_value());
  expect_alarm("the drive goes on");
  ASSERT_TRUE(write_now({field("control_command", Raw{1})}).has_value());
  expect_no_alarm();
  EXPECT_FALSE(control_.told.back().timeout);
  run(kTimeout + 30ms);
  expect_alarm("no sign of life");
}

TEST_F(TimeoutOnBusTest, CeaseEndsTheRepetition) {
  act_by(config::OnTimeout::cease);
  model_.node.rpdos[0].event_timer = std::uint16_t{300};
  bring_online();
  run_motor();
  run(kTimeout - 30ms);
  EXPECT_GE(rpdos().size(), 3U);
  run(60ms);
  expect_alarm("repeated no more");
  slave_.forget_heard();
  run(2s);
  expect_silence();
  ASSERT_TRUE(write_all(1, 20.0).has_value());
  expect_no_alarm();
  run(kTimeout - 100ms);
  EXPECT_GE(rpdos().size(), 3U) << "a new command is repeated again";
}

TEST_F(TimeoutOnBusTest, AStopPassesWhatWaitsAndTheLease) {
  write_on_timeout("control_command", kStopWord);
  model_.commands.lease = 10s;
  bring_online();
  run_motor();
  slave_.mute_sdo(true);
  const auto slow = write_by(plc_, {field("upper_limit", Raw{4000})});
  const auto waiting = write_by(plc_, {field("control_command", Raw{2})});
  run(kTimeout - 10ms);
  EXPECT_TRUE(rpdos().empty());
  EXPECT_FALSE(waiting.done());
  run(20ms);
  EXPECT_EQ(rpdos(), std::vector<Bytes>({{5, 0, 0xB8, 0x0B, 0, 0}}));
  expect_refused(finish(waiting), ErrorKind::superseded);
  expect_alarm("its values were written");
  EXPECT_EQ(drive_->control().holder, plc_) << "the gateway takes no lease";
  EXPECT_EQ(observer_.answers.back().first.writer.way, Writer::Way::gateway);
  slave_.mute_sdo(false);
  run(3s);
  EXPECT_EQ(rpdos().size(), 1U) << "once it is confirmed it is written no more";
  expect_alarm("its values were written");
}

TEST_F(TimeoutOnBusTest, AStopIsRepeatedEachSecondUntilItIsConfirmed) {
  write_on_timeout("control_command", kStopWord);
  bring_online();
  run_motor_by_sdo();
  mute_control();
  run(kTimeout + 10ms);
  EXPECT_EQ(sdo_writes(), Objects{test::kControl});
  run(900ms);
  EXPECT_EQ(sdo_writes().size(), 1U);
  expect_alarm("its values are not confirmed");
  run(100ms);
  EXPECT_EQ(sdo_writes().size(), 2U);
  mute_control_ = false;
  run(1s);
  EXPECT_EQ(sdo_writes().size(), 3U);
  EXPECT_EQ(slave_.value(test::kControl), kStopWord);
  expect_alarm("its values were written");
  run(3s);
  EXPECT_EQ(sdo_writes().size(), 3U);
  ASSERT_TRUE(write_now({field("control_command", kStopWord)}).has_value());
  expect_no_alarm();
  run(2 * kTimeout);
  expect_no_alarm();
}

TEST_F(TimeoutOnBusTest, ANewCommandEndsTheRepetitionOfTheValues) {
  write_on_timeout("control_command", kStopWord);
  bring_online();
  run_motor_by_sdo();
  mute_control();
  run(kTimeout + 900ms);
  EXPECT_FALSE(sdo_writes().empty());
  mute_control_ = false;
  EXPECT_TRUE(finish(write({field("control_command", Raw{1})}), 200ms).has_value());
  expect_no_alarm();
  slave_.forget_heard();
  for (int i = 0; i < 10; ++i) {
    run(200ms);
    drive_->sign_of_life(plc_);
  }
  EXPECT_EQ(sdo_writes(), Objects{});
  EXPECT_TRUE(rpdos().empty());
  EXPECT_EQ(slave_.value(test::kControl), 1U);
}

TEST_F(TimeoutOnBusTest, SetPointsAlone) {
  write_on_timeout("frequency_command", 1000);
  bring_online();
  run_motor();
  run(kTimeout + 10ms);
  EXPECT_EQ(rpdos(), std::vector<Bytes>({{1, 0, 0xE8, 0x03, 0, 0}}));
  EXPECT_TRUE(sdo_writes().empty());
  expect_alarm("its values were written");
  run(3s);
  EXPECT_EQ(rpdos().size(), 1U);
}

TEST_F(TimeoutOnBusTest, AStopAndSetPointsStopFirst) {
  write_on_timeout("frequency_command", 0);
  write_on_timeout("control_command", kStopWord);
  bring_online();
  run_motor_by_sdo();
  run(kTimeout + 20ms);
  EXPECT_EQ(sdo_writes(), (Objects{test::kControl, test::kFrequency}));
  expect_alarm("its values were written");
}

TEST_F(TimeoutOnBusTest, CountsFromTheTakeoverOfARunningDrive) {
  write_on_timeout("control_command", kStopWord);
  take_over_running();
  run(kTimeout - 150ms);
  expect_no_alarm();
  EXPECT_TRUE(sdo_writes().empty());
  run(200ms);
  expect_alarm("no sign of life of any writer");
  EXPECT_EQ(sdo_writes(), Objects{test::kControl});
}

TEST_F(TimeoutOnBusTest, AfterATakeoverAnyWriterWillDo) {
  act_by(config::OnTimeout::hold);
  take_over_running();
  run(300ms);
  drive_->sign_of_life(panel_);
  run(kTimeout - 30ms);
  expect_no_alarm();
  drive_->sign_of_life(mqtt_);
  run(kTimeout - 30ms);
  expect_no_alarm();
  run(60ms);
  expect_alarm("no sign of life of any writer");
}

TEST_F(TimeoutOnBusTest, ADriveThatComesBackGetsNoValues) {
  write_on_timeout("control_command", kStopWord);
  bring_online();
  run_motor_by_sdo();
  make_drive_unreachable(true);
  run(3s);
  ASSERT_FALSE(drive_->status().online);
  EXPECT_FALSE(sdo_writes().empty());
  expect_alarm("given up");
  slave_.forget_heard();
  make_drive_unreachable(false);
  status_word_ = 0;
  slave_.boot_up();
  run(5s);
  ASSERT_TRUE(drive_->status().online) << drive_->status().boot_text;
  const auto writes = sdo_writes();
  EXPECT_EQ(std::count(writes.begin(), writes.end(), test::kControl), 0);
  EXPECT_TRUE(rpdos().empty());
  expect_alarm("given up");
}

TEST_F(TimeoutOnBusTest, SignsOfLifeOfItsWriterPostponeIt) {
  act_by(config::OnTimeout::hold);
  bring_online();
  run_motor();
  for (int i = 0; i < 5; ++i) {
    run(kTimeout - 50ms);
    drive_->sign_of_life(plc_);
  }
  expect_no_alarm();
  run(kTimeout - 50ms);
  drive_->sign_of_life(panel_);
  drive_->sign_of_life(mqtt_);
  run(60ms);
  expect_alarm("no sign of life of modbus 192.0.2.7");
}

TEST_F(TimeoutOnBusTest, TheLeaseIsShownAndKeptAgainstAllOthers) {
  model_.commands.lease = 2s;
  bring_online();
  run_motor();
  ASSERT_EQ(control_.told.size(), 1U);
  EXPECT_EQ(control_.told.back().holder, plc_);
  for (const Writer& other : {panel_, mqtt_, local_}) {
    expect_refused(finish(write_by(other, {field("frequency_command", 20.0)})), ErrorKind::lease);
    expect_refused(finish(write_by(other, {field("control_command", Raw{1})})), ErrorKind::lease);
  }
  expect_silence();
  EXPECT_EQ(drive_->control().holder, plc_);
  run(2s);
  EXPECT_FALSE(drive_->control().holder);
  ASSERT_EQ(control_.told.size(), 2U);
  EXPECT_FALSE(control_.told.back().holder);
  EXPECT_TRUE(finish(write_by(mqtt_, {field("frequency_command", 20.0)})).has_value());
  EXPECT_EQ(drive_->control().holder, mqtt_);
  expect_refused(write_now({field("frequency_command", 20.0)}), ErrorKind::lease);
}

TEST_F(TimeoutOnBusTest, AMotorThatDoesNotFollowIsAnAlarmUntilItDoes) {
  model_.commands.feedback = 300ms;
  bring_online();
  ASSERT_TRUE(write_all(1, 30.0).has_value());
  run(270ms);
  EXPECT_FALSE(alarm(alarms::AlarmKind::control).active);
  run(60ms);
  EXPECT_TRUE(alarm(alarms::AlarmKind::control).active);
  EXPECT_NE(alarm(alarms::AlarmKind::control).text.find("running is still false 300ms"), std::string::npos)
      << alarm(alarms::AlarmKind::control).text;
  EXPECT_FALSE(drive_->control().timeout);
  show(test::kRunningBit);
  EXPECT_FALSE(alarm(alarms::AlarmKind::control).active);
}

}  // namespace
}  // namespace process
