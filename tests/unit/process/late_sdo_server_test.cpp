// What users see of a drive whose SDO server wakes up seconds after its boot-up (`sdo.patience`): no alarm, then
// values.

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/unit/process/drive_bench.h"

namespace process {
namespace {

using namespace std::chrono_literals;

class LateSdoServerTest : public DriveBench {
 protected:
  LateSdoServerTest() { model_.node.sdo.patience = 6s; }

  void boot_with_a_silent_server() {
    slave_.mute_sdo(true);
    start();
    slave_.boot_up();
    run(4s);
  }
  [[nodiscard]] bool any_alarm() const {
    return std::any_of(alarms::kAlarmKinds.begin(), alarms::kAlarmKinds.end(),
                       [this](alarms::AlarmKind kind) { return alarm(kind).active || alarm(kind).count > 0; });
  }
};

TEST_F(LateSdoServerTest, OneThatWakesUpAfterFourSecondsHasNoAlarm) {
  boot_with_a_silent_server();
  EXPECT_FALSE(any_alarm());
  EXPECT_FALSE(drive_->status().online);
  const Outcome outcome = write_now({field("control_command", Raw{1})});
  ASSERT_TRUE(outcome.failure);
  EXPECT_EQ(outcome.failure->kind, canopen::ErrorKind::offline) << "as of any drive that boots";
  slave_.mute_sdo(false);
  run(4s);
  EXPECT_TRUE(drive_->status().online) << drive_->status().boot_text;
  EXPECT_TRUE(fresh("running"));
  EXPECT_FALSE(any_alarm());
}

TEST_F(LateSdoServerTest, OneThatNeverWakesUpHasItsLetterAfterThatTime) {
  boot_with_a_silent_server();
  run(1900ms);
  EXPECT_FALSE(any_alarm());
  run(5s);
  EXPECT_TRUE(alarm(alarms::AlarmKind::boot).active);
  EXPECT_EQ(alarm(alarms::AlarmKind::boot).reason, "no-answer");
  EXPECT_EQ(alarm(alarms::AlarmKind::boot).text.substr(0, 34), "B: it answers no SDO request: hear");
  EXPECT_NE(alarm(alarms::AlarmKind::boot).text.find("What to do first: check that it is switched on"),
            std::string::npos)
      << alarm(alarms::AlarmKind::boot).text;
  EXPECT_FALSE(alarm(alarms::AlarmKind::heartbeat).active);
}

}  // namespace
}  // namespace process
