#include "bridges/alarms/drive_alarms.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "bridges/alarms/reason.h"

namespace alarms {
namespace {

AlarmRecord record_of(const config::Drive& model, AlarmKind kind) {
  return AlarmRecord(model.name + "-" + std::string(name_of(kind)));
}

std::string heartbeat_text(const config::Drive& model, const canopen::NodeStatus& status) {
  const auto timeout =
      std::chrono::duration_cast<std::chrono::milliseconds>(model.node.error_control.heartbeat_timeout).count();
  if (!status.last_heartbeat && status.heartbeat_losses == 0) {
    return "the drive has not appeared on the bus";
  }
  return "no heartbeat for " + std::to_string(timeout) + " ms";
}

std::string boot_text(const canopen::NodeStatus& status) {
  if (!is_letter(status.boot_result)) {
    return status.boot_text;
  }
  const std::string letter(1, static_cast<char>(status.boot_result));
  return letter + ": " + (status.boot_text.empty() ? std::string(text_of(status.boot_result)) : status.boot_text);
}

}  // namespace

DriveAlarms::DriveAlarms(const config::Drive& model, Changed changed)
    : model_(model),
      changed_(std::move(changed)),
      errors_(model),
      records_{record_of(model, AlarmKind::emcy), record_of(model, AlarmKind::heartbeat),
               record_of(model, AlarmKind::boot), record_of(model, AlarmKind::data),
               record_of(model, AlarmKind::control)} {
  // Nothing is known of the drive yet.
  record(AlarmKind::emcy).show({}, 0, false, {});
}

void DriveAlarms::on_emcy(const canopen::Emcy& emcy, canopen::TimePoint at, canopen::WallTime wall) {
  if (errors_.on_emcy(emcy, at, wall)) {
    show_emcy(wall, at);
  }
}

void DriveAlarms::on_bit(config::Severity severity, bool set, canopen::Duration period, canopen::TimePoint at,
                         canopen::WallTime wall) {
  if (errors_.on_signal(severity, set, period, at, wall)) {
    show_emcy(wall, at);
  }
}

void DriveAlarms::on_fault_code(std::uint64_t code, canopen::WallTime wall) {
  if (errors_.on_fault_code(code)) {
    show_emcy(wall);
  }
}

void DriveAlarms::on_readings(const ErrorReadings& readings, canopen::TimePoint at, canopen::WallTime wall) {
  if (errors_.on_readings(readings, at, wall)) {
    show_emcy(wall, at);
  }
}

void DriveAlarms::on_stale_bit(config::Severity severity, canopen::TimePoint at) {
  errors_.on_stale_signal(severity, at);
}

void DriveAlarms::on_error_register(const ErrorReadings& readings, canopen::TimePoint at, canopen::WallTime wall) {
  if (errors_.on_error_register(readings, at)) {
    show_emcy(wall, at);
  }
}

void DriveAlarms::on_status(const canopen::NodeStatus& status, canopen::WallTime wall) {
  was_online_ = was_online_ || status.online;
  if (errors_.on_online(status.online)) {
    show_emcy(wall);
  }
  show(AlarmKind::heartbeat, status.lost, heartbeat_reason(status), heartbeat_text(model_, status), wall);
  show(AlarmKind::boot, is_letter(status.boot_result) || !status.boot_text.empty(), boot_reason(status),
       boot_text(status), wall);
}

void DriveAlarms::on_data_problems(const std::vector<DataProblem>& problems, canopen::WallTime wall) {
  std::string text;
  for (const DataProblem& problem : problems) {
    text += text.empty() ? problem.text : "; " + problem.text;
  }
  const std::string_view reason = problems.empty() ? std::string_view() : name_of(problems.front().reason);
  show(AlarmKind::data, !problems.empty(), reason, std::move(text), wall);
}

void DriveAlarms::on_control(const std::optional<ControlAlarm>& alarm, canopen::WallTime wall) {
  show(AlarmKind::control, alarm.has_value(), alarm ? name_of(alarm->reason) : std::string_view(),
       alarm ? alarm->text : std::string(), wall);
}

void DriveAlarms::restore_emcy(const Alarm& before) {
  if (was_online_) {
    if (record(AlarmKind::emcy).continue_from(before)) {
      changed_(AlarmKind::emcy);
    }
    return;
  }
  if (std::exchange(restored_, true)) {
    return;
  }
  errors_.restore(before);
  record(AlarmKind::emcy).restore(before);
  record(AlarmKind::emcy).show(errors_.errors(), errors_.error_register(), errors_.confirmed(), before.ts);
  changed_(AlarmKind::emcy);
}

const Alarm& DriveAlarms::alarm(AlarmKind kind) const noexcept {
  return records_[static_cast<std::size_t>(kind)].alarm();
}

bool DriveAlarms::any(config::Severity severity) const noexcept {
  return std::any_of(records_.begin(), records_.end(), [severity](const AlarmRecord& record) {
    const std::vector<AlarmError>& errors = record.alarm().errors;
    return std::any_of(errors.begin(), errors.end(),
                       [severity](const AlarmError& error) { return error.severity == severity; });
  });
}

void DriveAlarms::set_first(AlarmKind kind, bool first, canopen::WallTime wall) {
  if (record(kind).set_first(first, wall) && telling_ != kind) {
    changed_(kind);
  }
}

void DriveAlarms::show_emcy(canopen::WallTime wall, canopen::TimePoint at) {
  if (record(AlarmKind::emcy)
          .show(errors_.errors(), errors_.error_register(), errors_.confirmed(), wall)) {
    tell(AlarmKind::emcy, at);
  }
}

void DriveAlarms::show(AlarmKind kind, bool active, std::string_view reason, std::string text, canopen::WallTime wall) {
  if (record(kind).show(active, std::string(reason), std::move(text), severity_of(kind), wall)) {
    tell(kind, canopen::Clock::now());
  }
}

void DriveAlarms::tell(AlarmKind kind, canopen::TimePoint at) {
  if (fault_began_ && record(kind).fault_began()) {
    telling_ = kind;
    fault_began_(kind, at);
    telling_.reset();
  }
  changed_(kind);
}

}  // namespace alarms
