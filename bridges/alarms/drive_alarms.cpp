#include "bridges/alarms/drive_alarms.h"

#include <algorithm>
#include <chrono>
#include <utility>

namespace alarms {
namespace {

bool tells_its_state(const canopen::NodeStatus& status) {
  return status.online || status.lost || status.boot_result != canopen::BootResult::not_booted ||
         !status.boot_text.empty();
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

DriveAlarms::DriveAlarms(const config::Drive& model, Changed changed, const NewId& new_id)
    : model_(model),
      changed_(std::move(changed)),
      emergencies_(model),
      records_{AlarmRecord(new_id), AlarmRecord(new_id), AlarmRecord(new_id), AlarmRecord(new_id),
               AlarmRecord(new_id)} {
  decide(AlarmKind::control);
  record(AlarmKind::control).show(false, {}, config::Severity::fault, {});
  if (!model.enabled) {  // Nothing of it will ever be learnt, so nothing is waited for.
    decided_.set();
    for (const AlarmKind kind : kAlarmKinds) {
      record(kind).show({}, 0, kind != AlarmKind::emcy, {});
    }
  }
}

void DriveAlarms::restore(AlarmKind kind, const Alarm& before) {
  if (!model_.enabled) {
    return;
  }
  record(kind).restore(before);
  if (kind == AlarmKind::emcy) {
    emergencies_.restore(before);
  }
  if (kind == AlarmKind::control && before.active) {
    decided_.reset(static_cast<std::size_t>(kind));
  }
  if (before.active) {
    changed_(kind);
  }
}

void DriveAlarms::on_emcy(const canopen::Emcy& emcy, canopen::TimePoint at, canopen::WallTime wall) {
  if (emergencies_.on_emcy(emcy, at, wall)) {
    show_emcy(wall);
  }
}

void DriveAlarms::on_bit(config::Severity severity, bool set, canopen::Duration period, canopen::TimePoint at,
                         canopen::WallTime wall) {
  const bool first = !std::exchange(bit_told_, true);
  decide_emcy_if_asked();
  if (emergencies_.on_bit(severity, set, period, at, wall) || first) {
    show_emcy(wall);
  }
}

void DriveAlarms::on_fault_code(std::uint64_t code, canopen::WallTime wall) {
  if (emergencies_.on_fault_code(code)) {
    show_emcy(wall);
  }
}

void DriveAlarms::on_readings(const ErrorReadings& readings, canopen::TimePoint at, canopen::WallTime wall) {
  asked_ = true;
  if (readings.error_register) {
    decide(AlarmKind::emcy);
  }
  decide_emcy_if_asked();
  if (emergencies_.on_readings(readings, at, wall)) {
    show_emcy(wall);
  }
}

// Without 0x1001 the bits tell, where there are any.
void DriveAlarms::decide_emcy_if_asked() noexcept {
  const bool has_bits = model_.faults.fault.has_value() || model_.faults.warning.has_value();
  if (asked_ && (bit_told_ || !has_bits)) {
    decide(AlarmKind::emcy);
  }
}

void DriveAlarms::on_status(const canopen::NodeStatus& status, canopen::WallTime wall) {
  emergencies_.on_online(status.online);
  if (tells_its_state(status)) {
    decide(AlarmKind::heartbeat);
    decide(AlarmKind::boot);
    if (!status.online) {
      decide(AlarmKind::emcy);  // As it was: who is missing tells no more.
    }
    if (!status.online || status.nmt != canopen::NmtState::operational) {
      decide(AlarmKind::data);
    }
  }
  show_emcy(wall);
  show(AlarmKind::heartbeat, status.lost, heartbeat_text(model_, status), config::Severity::fault, wall);
  show(AlarmKind::boot, is_letter(status.boot_result) || !status.boot_text.empty(), boot_text(status),
       config::Severity::fault, wall);
  show_data(wall);
}

void DriveAlarms::on_data_problems(const std::vector<std::string>& problems, canopen::WallTime wall) {
  data_.clear();
  for (const std::string& problem : problems) {
    data_ += data_.empty() ? problem : "; " + problem;
  }
  show_data(wall);
}

void DriveAlarms::on_control(const std::optional<ControlAlarm>& alarm, canopen::WallTime wall) {
  show(AlarmKind::control, alarm.has_value(), alarm ? alarm->text : std::string(), config::Severity::fault, wall);
}

void DriveAlarms::on_control_command(canopen::WallTime wall) {
  end_control(wall);
}

void DriveAlarms::on_running(canopen::WallTime wall) {
  if (alarm(AlarmKind::control).reason == name_of(ControlReason::feedback)) {
    end_control(wall);
  }
}

// Once decided it is the arbiter that tells of it.
void DriveAlarms::end_control(canopen::WallTime wall) {
  if (!decided(AlarmKind::control)) {
    decide(AlarmKind::control);
    show(AlarmKind::control, false, {}, config::Severity::fault, wall);
  }
}

void DriveAlarms::on_settled(canopen::WallTime wall) {
  decide(AlarmKind::data);
  show_data(wall);
  bit_told_ = true;  // As far as it ever will.
  decide_emcy_if_asked();
  show_emcy(wall);
}

void DriveAlarms::on_patience_over(canopen::WallTime wall) {
  for (const AlarmKind kind : kAlarmKinds) {
    if (alarm(kind).known) {
      continue;
    }
    decide(kind);
    if (kind != AlarmKind::emcy) {
      show(kind, false, {}, config::Severity::fault, wall);
    }
  }
  show_emcy(wall);
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

void DriveAlarms::show_emcy(canopen::WallTime wall) {
  std::vector<AlarmError> errors = emergencies_.errors();
  if (errors.empty() && !alarm(AlarmKind::emcy).known && !decided(AlarmKind::emcy)) {
    return;
  }
  if (record(AlarmKind::emcy).show(std::move(errors), emergencies_.error_register(), emergencies_.confirmed(), wall)) {
    changed_(AlarmKind::emcy);
  }
}

void DriveAlarms::show_data(canopen::WallTime wall) {
  show(AlarmKind::data, !data_.empty(), data_, config::Severity::warning, wall);
}

void DriveAlarms::show(AlarmKind kind, bool active, std::string text, config::Severity severity,
                       canopen::WallTime wall) {
  if (active) {
    decide(kind);
  }
  if (decided(kind) && record(kind).show(active, std::move(text), severity, wall)) {
    changed_(kind);
  }
}

}  // namespace alarms
