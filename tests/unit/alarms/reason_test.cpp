#include "bridges/alarms/reason.h"

#include <gtest/gtest.h>

#include <string_view>
#include <vector>

#include "bridges/alarms/control_alarm.h"

namespace alarms {
namespace {

using canopen::BootResult;
using canopen::BusCondition;
using canopen::HeldBack;
using config::Severity;

TEST(ReasonTest, OfAHeartbeatAlarm) {
  canopen::NodeStatus status;
  status.lost = true;
  EXPECT_EQ(heartbeat_reason(status), "never-appeared");
  status.last_heartbeat = canopen::TimePoint(std::chrono::hours(1));
  EXPECT_EQ(heartbeat_reason(status), "lost");
  status.last_heartbeat.reset();
  status.heartbeat_losses = 1;
  EXPECT_EQ(heartbeat_reason(status), "lost");
}

TEST(ReasonTest, OfABootAlarm) {
  struct Case {
    BootResult result;
    HeldBack held_back;
    const char* text;
    std::string_view reason;
  };
  const std::vector<Case> cases{
      {BootResult::ok, HeldBack::no, "", ""},
      {BootResult::not_booted, HeldBack::no, "", ""},
      {BootResult::not_booted, HeldBack::no, "its heartbeat is slow", "undecided"},
      {BootResult::no_answer, HeldBack::no, "", "no-answer"},
      {BootResult::other_device_type, HeldBack::no, "", "other-device-type"},
      {BootResult::other_vendor, HeldBack::no, "", "other-vendor"},
      {BootResult::no_error_control, HeldBack::no, "", "no-error-control"},
      {BootResult::not_configured, HeldBack::no, "", "not-configured"},
      {BootResult::not_configured, HeldBack::left_operational, "why", "left-operational"},
      {BootResult::not_configured, HeldBack::found_stopped, "why", "found-stopped"},
      {BootResult::not_configured, HeldBack::start_ignored, "why", "start-ignored"},
      {BootResult::no_heartbeat, HeldBack::no, "", "no-heartbeat"},
      {BootResult::no_guarding, HeldBack::no, "", "no-guarding"},
      {BootResult::left_alone, HeldBack::no, "", "left-alone"},
      {BootResult::other_product, HeldBack::no, "", "other-product"},
      {BootResult::other_revision, HeldBack::no, "", "other-revision"},
      {BootResult::other_serial_number, HeldBack::no, "", "other-serial-number"},
  };
  for (const Case& one : cases) {
    canopen::NodeStatus status;
    status.boot_result = one.result;
    status.held_back = one.held_back;
    status.boot_text = one.text;
    EXPECT_EQ(boot_reason(status), one.reason);
  }
}

TEST(ReasonTest, AndSeverityOfABusAlarm) {
  struct Case {
    BusCondition condition;
    std::string_view reason;
    Severity severity;
  };
  const std::vector<Case> cases{
      {BusCondition::warning, "warning", Severity::warning},
      {BusCondition::passive, "passive", Severity::warning},
      {BusCondition::bus_off, "bus-off", Severity::fault},
      {BusCondition::down, "down", Severity::fault},
  };
  for (const Case& one : cases) {
    EXPECT_EQ(bus_reason(one.condition), one.reason);
    EXPECT_EQ(severity_of(one.condition), one.severity) << one.reason;
  }
  EXPECT_EQ(bus_reason(BusCondition::error_active), "");
}

TEST(ReasonTest, OfAControlAlarm) {
  EXPECT_EQ(name_of(ControlReason::timeout), "timeout");
  EXPECT_EQ(name_of(ControlReason::timeout_failed), "timeout-failed");
  EXPECT_EQ(name_of(ControlReason::feedback), "feedback");
}

TEST(ReasonTest, SeverityOfAKind) {
  EXPECT_EQ(severity_of(AlarmKind::heartbeat), Severity::fault);
  EXPECT_EQ(severity_of(AlarmKind::boot), Severity::fault);
  EXPECT_EQ(severity_of(AlarmKind::control), Severity::fault);
  EXPECT_EQ(severity_of(AlarmKind::data), Severity::warning);
}

}  // namespace
}  // namespace alarms
