#include "bridges/alarms/alarm_record.h"

#include <utility>

namespace alarms {
namespace {

// The newest of the faults, where there is one, else of all.
const AlarmError& foremost(const std::vector<AlarmError>& errors) {
  const AlarmError* best = &errors.front();
  for (const AlarmError& error : errors) {
    if (error.severity >= best->severity) {
      best = &error;
    }
  }
  return *best;
}

}  // namespace

AlarmRecord::AlarmRecord(NewId new_id) : new_id_(std::move(new_id)) {
  alarm_.confirmed = false;
}

bool AlarmRecord::show(std::vector<AlarmError> errors, std::uint8_t error_register, bool confirmed,
                       canopen::WallTime now) {
  const Alarm before = alarm_;
  alarm_.known = true;
  alarm_.errors = std::move(errors);
  alarm_.active = !alarm_.errors.empty();
  alarm_.known = alarm_.known || alarm_.active;  // Somebody told so.
  alarm_.error_register = error_register;
  alarm_.confirmed = confirmed;
  if (alarm_.active) {
    const AlarmError& error = foremost(alarm_.errors);
    alarm_.code = error.code;
    alarm_.text = error.text;
    alarm_.severity = error.severity;
    alarm_.vendor = error.vendor;
  }
  if (alarm_.active && !before.active) {
    ++alarm_.count;
    alarm_.id = new_id_();
    alarm_.since = now;
    alarm_.first = false;
  }
  if (!alarm_.active && before.active) {
    alarm_.cleared = now;
  }
  if (alarm_ == before) {
    return false;
  }
  if (before.known || alarm_.active) {  // That there is none is no change: it only became known.
    alarm_.ts = now;
  }
  return true;
}

bool AlarmRecord::show(bool active, std::string text, config::Severity severity, canopen::WallTime now) {
  std::vector<AlarmError> errors;
  if (active) {
    errors.push_back({0, {}, std::move(text), severity, alarm_.active ? alarm_.since : now});
  }
  return show(std::move(errors), 0, true, now);
}

void AlarmRecord::restore(const Alarm& before) {
  alarm_ = before;
  alarm_.confirmed = false;
  alarm_.known = true;
}

}  // namespace alarms
