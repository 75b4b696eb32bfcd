// A drive that the site took out of service.

#include <gtest/gtest.h>

#include "tests/unit/process/commands_fixture.h"

namespace process {
namespace {

using namespace std::chrono_literals;

class OutOfServiceTest : public CommandsTest {
 protected:
  OutOfServiceTest() { model_.enabled = false; }

  void expect_offline(const Outcome& outcome) {
    expect_refused(outcome, ErrorKind::offline);
    ASSERT_TRUE(outcome.has_error());
    EXPECT_NE(outcome.error().detail.find("out of service"), std::string::npos) << outcome.error().detail;
    EXPECT_FALSE(outcome.error().outcome_unknown);
  }
  void expect_untouched() {
    EXPECT_TRUE(slave_.heard().empty());
    EXPECT_FALSE(drive_->status().online);
    EXPECT_FALSE(drive_->has_fault_alarm());
    EXPECT_FALSE(drive_->has_warning_alarm());
    EXPECT_FALSE(fresh("status_word"));
    EXPECT_EQ(observer_.statuses, 0);
    EXPECT_TRUE(observer_.alarms.empty());
    EXPECT_TRUE(observer_.values.empty());
    EXPECT_TRUE(observer_.remarks.empty());
  }
};

TEST_F(OutOfServiceTest, NothingIsSentAndNothingIsTold) {
  start();
  run(5s);
  expect_untouched();
  slave_.boot_up();
  run(5s);
  slave_.set_state(5);
  show(test::kRunningBit | test::kFaultBit);
  emcy(0x0004, 0x01);
  run(5s);
  slave_.heartbeat_off(true);
  silent_ = true;
  run(5s);
  expect_untouched();
}

TEST_F(OutOfServiceTest, EveryCommandIsRefused) {
  model_.commands.raw = true;
  start();
  slave_.set_state(5);
  run(1s);
  expect_offline(write_now({field("frequency_command", 20.0)}));
  expect_offline(write_all(1, 20.0));
  expect_offline(write_now({field("control_command", Raw{5})}));
  expect_offline(write_now({field("control_command", Raw{5}), field("frequency_command", 20.0)}));
  expect_offline(finish(support::spawn(loop_.executor(), drive_->stop_motor(origin()))));
  expect_offline(nmt_now(NmtCommand::start));
  expect_offline(nmt_now(NmtCommand::reset_node));
  expect_offline(sdo_write_now({test::kOutput, DataType::u16, 1}));
  const auto read = support::spawn(loop_.executor(), drive_->sdo_read(test::kOutput, DataType::u16));
  loop_.settle();
  ASSERT_TRUE(read.done());
  ASSERT_TRUE(read.get().has_error());
  EXPECT_EQ(read.get().error().kind, ErrorKind::offline);
  expect_refused(write_now({field("frequency_command", 60.0)}), ErrorKind::range);
  run(1s);
  expect_untouched();
}

TEST_F(OutOfServiceTest, WhoMayNotWriteIsToldThatFirst) {
  model_.commands.writers.modbus = false;
  start();
  expect_refused(write_now({field("control_command", Raw{5})}), ErrorKind::forbidden);
}

TEST_F(OutOfServiceTest, AnAlarmOfBeforeIsNotBroughtBack) {
  start();
  alarms::Alarm before;
  before.active = true;
  before.id = "1-pump1-emcy";
  before.errors = {{.code = 4, .text = "Overcurrent"}};
  drive_->restore(alarms::AlarmKind::emcy, before);
  EXPECT_FALSE(alarm(alarms::AlarmKind::emcy).active);
  expect_untouched();
}

}  // namespace
}  // namespace process
