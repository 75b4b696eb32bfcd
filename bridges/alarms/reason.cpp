#include "bridges/alarms/reason.h"

namespace alarms {
namespace {

using canopen::BootResult;
using canopen::BusCondition;
using canopen::HeldBack;

std::string_view letter_reason(BootResult letter) noexcept {
  switch (letter) {
    case BootResult::no_answer:
      return "no-answer";
    case BootResult::other_device_type:
      return "other-device-type";
    case BootResult::other_vendor:
      return "other-vendor";
    case BootResult::no_error_control:
      return "no-error-control";
    case BootResult::no_guarding:
      return "no-guarding";
    case BootResult::not_configured:
      return "not-configured";
    case BootResult::no_heartbeat:
      return "no-heartbeat";
    case BootResult::left_alone:
      return "left-alone";
    case BootResult::other_product:
      return "other-product";
    case BootResult::other_revision:
      return "other-revision";
    case BootResult::other_serial_number:
      return "other-serial-number";
    case BootResult::ok:
    case BootResult::not_booted:
      break;
  }
  return {};
}

std::string_view held_back_reason(HeldBack held_back) noexcept {
  switch (held_back) {
    case HeldBack::left_operational:
      return "left-operational";
    case HeldBack::found_stopped:
      return "found-stopped";
    case HeldBack::start_ignored:
      return "start-ignored";
    case HeldBack::no:
      break;
  }
  return {};
}

}  // namespace

std::string_view heartbeat_reason(const canopen::NodeStatus& status) noexcept {
  return !status.last_heartbeat && status.heartbeat_losses == 0 ? "never-appeared" : "lost";
}

std::string_view boot_reason(const canopen::NodeStatus& status) noexcept {
  if (status.boot_result == BootResult::not_configured && status.held_back != HeldBack::no) {
    return held_back_reason(status.held_back);
  }
  if (!is_letter(status.boot_result)) {
    return status.boot_text.empty() ? "" : "undecided";
  }
  return letter_reason(status.boot_result);
}

std::string_view bus_reason(BusCondition condition) noexcept {
  switch (condition) {
    case BusCondition::error_active:
      break;
    case BusCondition::warning:
      return "warning";
    case BusCondition::passive:
      return "passive";
    case BusCondition::bus_off:
      return "bus-off";
    case BusCondition::down:
      return "down";
  }
  return {};
}

config::Severity severity_of(AlarmKind kind) noexcept {
  return kind == AlarmKind::data ? config::Severity::warning : config::Severity::fault;
}

config::Severity severity_of(BusCondition condition) noexcept {
  const bool up = condition != BusCondition::bus_off && condition != BusCondition::down;
  return up ? config::Severity::warning : config::Severity::fault;
}

}  // namespace alarms
