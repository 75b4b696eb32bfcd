#include "bridges/alarms/drive_alarms.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "bridges/alarms/reason.h"

namespace alarms {
namespace {

/// Arrived, missing, or found not to be bootable. A text without a letter tells of a search that goes on.
bool tells_its_state(const canopen::NodeStatus& status) {
  return status.online || status.lost || status.boot_result != canopen::BootResult::not_booted;
}

// Of the drive, not of a life of it: they stand until somebody looks again.
bool outlives_absence(std::string_view data_reason) {
  return data_reason == name_of(DataReason::absent) || data_reason == name_of(DataReason::emcy_off) ||
         data_reason == name_of(DataReason::emcy_moved);
}

// Somebody may write `control_command`, now or when the drive is back.
bool can_be_commanded(const config::Drive& model) {
  const std::optional<std::size_t> control = model.find("control_command");
  return control && config::writable(model.signals[*control].access) && model.commands.writers.any();
}

std::string_view sign_of_life(const config::Drive& model) {
  switch (canopen::kind_of(model.node.error_control)) {
    case canopen::ErrorControlKind::heartbeat:
      return "heartbeat";
    case canopen::ErrorControlKind::guarding:
      return "guarding answer";
    case canopen::ErrorControlKind::none:
      break;
  }
  return "TPDO and no SDO answer";
}

std::string heartbeat_text(const config::Drive& model, const canopen::NodeStatus& status) {
  const auto timeout =
      std::chrono::duration_cast<std::chrono::milliseconds>(model.node.error_control.heartbeat_timeout).count();
  if (!status.last_heartbeat && status.heartbeat_losses == 0) {
    return "the drive has not appeared on the bus";
  }
  return "no " + std::string(sign_of_life(model)) + " for " + std::to_string(timeout) + " ms";
}

std::string boot_text(const canopen::NodeStatus& status) {
  if (!is_letter(status.boot_result)) {
    return status.boot_text;
  }
  // Where no setting is the cause, the text says what the letter means.
  const bool says_it = status.held_back != canopen::HeldBack::no && !status.boot_text.empty();
  std::string text(1, static_cast<char>(status.boot_result));
  text += ": " + (says_it ? status.boot_text : std::string(text_of(status.boot_result, status.held_back)));
  if (!says_it && !status.boot_text.empty()) {
    text += ": " + status.boot_text;
  }
  return text + ". What to do first: " + std::string(first_steps(status.boot_result, status.held_back));
}

AlarmRecord record_of(AlarmKind kind, const NewId& new_id) {
  return AlarmRecord(new_id, severity_of(kind));
}

}  // namespace

DriveAlarms::DriveAlarms(const config::Drive& model, Changed changed, const NewId& new_id)
    : model_(model),
      changed_(std::move(changed)),
      errors_(model),
      records_{record_of(AlarmKind::emcy, new_id), record_of(AlarmKind::heartbeat, new_id),
               record_of(AlarmKind::boot, new_id), record_of(AlarmKind::data, new_id),
               record_of(AlarmKind::control, new_id)} {
  if (!model_.enabled) {  // Nothing of it will ever be learnt, so nothing is waited for.
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
    errors_.restore(before);
  }
  if (kind == AlarmKind::control) {
    awaits_command_ = before.active && can_be_commanded(model_);
  }
  if (before.active) {
    changed_(kind);
  }
}

void DriveAlarms::on_emcy(const canopen::Emcy& emcy, canopen::TimePoint at, canopen::WallTime wall) {
  if (errors_.on_emcy(emcy, at, wall)) {
    show_emcy(wall, at);
  }
}

void DriveAlarms::on_bit(config::Severity severity, bool set, canopen::Duration period, canopen::TimePoint at,
                         canopen::WallTime wall) {
  const bool first = !std::exchange(bit_told_, true);
  decide_emcy_if_asked();
  if (errors_.on_signal(severity, set, period, at, wall) || first) {
    show_emcy(wall, at);
  }
}

void DriveAlarms::on_stale_bit(config::Severity severity, canopen::TimePoint at) {
  errors_.on_stale_signal(severity, at);
}

void DriveAlarms::on_fault_code(std::uint64_t code, canopen::WallTime wall) {
  if (errors_.on_fault_code(code)) {
    show_emcy(wall);
  }
}

void DriveAlarms::on_readings(const ErrorReadings& readings, canopen::TimePoint at, canopen::WallTime wall) {
  asked_ = asked_ || readings.error_register || readings.register_absent || !model_.faults.has_error_register;
  if (readings.error_register) {
    decide(AlarmKind::emcy);
  }
  decide_emcy_if_asked();
  if (errors_.on_readings(readings, at, wall)) {
    show_emcy(wall, at);
  }
}

void DriveAlarms::on_error_register(const ErrorReadings& readings, canopen::TimePoint at, canopen::WallTime wall) {
  if (errors_.on_error_register(readings, at)) {
    show_emcy(wall, at);
  }
}

// Without 0x1001 the bits tell, where there are any.
void DriveAlarms::decide_emcy_if_asked() noexcept {
  const bool has_bits = model_.faults.fault.has_value() || model_.faults.warning.has_value();
  if (asked_ && (bit_told_ || !has_bits)) {
    decide(AlarmKind::emcy);
  }
}

void DriveAlarms::on_boot_up(canopen::TimePoint at, canopen::WallTime wall) {
  if (errors_.on_boot_up(at)) {
    show_emcy(wall, at);
  }
}

void DriveAlarms::on_status(const canopen::NodeStatus& status, canopen::WallTime wall) {
  errors_.on_online(status.online);
  const bool told = tells_its_state(status);
  if (told) {
    decide(AlarmKind::heartbeat);
    decide(AlarmKind::boot);
    if (!status.online) {
      decide(AlarmKind::emcy);  // As it was: who is missing tells no more.
    }
    const bool lives = status.online && status.nmt_now() == canopen::NmtState::operational;
    if (!lives && !outlives_absence(alarm(AlarmKind::data).reason)) {
      decide(AlarmKind::data);
    }
  }
  show_emcy(wall);
  show(AlarmKind::heartbeat, status.lost, heartbeat_reason(status), heartbeat_text(model_, status), wall);
  show(AlarmKind::boot, is_letter(status.boot_result) || !status.boot_text.empty(), boot_reason(status),
       boot_text(status), wall);
  show_data(wall);
  if (told && !awaits_command_) {
    end_control(wall);
  }
}

void DriveAlarms::on_data_problems(const std::vector<DataProblem>& problems, canopen::WallTime wall) {
  decide(AlarmKind::data);
  data_.clear();
  data_reason_ = problems.empty() ? std::string_view() : name_of(problems.front().reason);
  for (const DataProblem& problem : problems) {
    data_ += data_.empty() ? problem.text : "; " + problem.text;
  }
  show_data(wall);
}

void DriveAlarms::on_control(const std::optional<ControlAlarm>& alarm, canopen::WallTime wall) {
  show(AlarmKind::control, alarm.has_value(), alarm ? name_of(alarm->reason) : std::string_view(),
       alarm ? alarm->text : std::string(), wall);
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
    show(AlarmKind::control, false, {}, {}, wall);
  }
}

void DriveAlarms::on_settled(canopen::WallTime wall) {
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
      show(kind, false, {}, {}, wall);
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

void DriveAlarms::set_first(AlarmKind kind, bool first, canopen::WallTime wall) {
  if (record(kind).set_first(first, wall) && telling_ != kind) {
    changed_(kind);
  }
}

void DriveAlarms::set_record(AlarmKind kind, std::string name) {
  if (record(kind).set_record(std::move(name))) {
    changed_(kind);
  }
}

void DriveAlarms::show_emcy(canopen::WallTime wall, canopen::TimePoint at) {
  std::vector<AlarmError> errors = errors_.errors();
  if (errors.empty() && !alarm(AlarmKind::emcy).known && !decided(AlarmKind::emcy)) {
    return;
  }
  if (record(AlarmKind::emcy).show(std::move(errors), errors_.error_register(), errors_.confirmed(), wall)) {
    tell(AlarmKind::emcy, at);
  }
}

void DriveAlarms::show_data(canopen::WallTime wall) {
  show(AlarmKind::data, !data_.empty(), data_reason_, data_, wall);
}

void DriveAlarms::show(AlarmKind kind, bool active, std::string_view reason, std::string text, canopen::WallTime wall) {
  if (active) {
    decide(kind);
  }
  if (decided(kind) && record(kind).show(active, std::string(reason), std::move(text), severity_of(kind), wall)) {
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
