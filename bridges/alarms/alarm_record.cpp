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

// An error keeps its beginning when it gets another name, and its name when it comes again.
bool has_new_fault(const std::vector<AlarmError>& before, const std::vector<AlarmError>& now) {
  return std::any_of(now.begin(), now.end(), [&](const AlarmError& error) {
    return error.severity == config::Severity::fault &&
           std::none_of(before.begin(), before.end(), [&](const AlarmError& old) {
             return old.severity == config::Severity::fault &&
                    (old.since == error.since || (old.code == error.code && old.vendor == error.vendor));
           });
  });
}

}  // namespace

AlarmRecord::AlarmRecord(NewId new_id, config::Severity severity) : new_id_(std::move(new_id)) {
  alarm_.severity = severity;
  alarm_.confirmed = false;
}

bool AlarmRecord::show(std::vector<AlarmError> errors, std::uint8_t error_register, bool confirmed,
                       canopen::WallTime now, std::string reason) {
  const Alarm before = alarm_;
  alarm_.known = true;
  alarm_.errors = std::move(errors);
  alarm_.active = !alarm_.errors.empty();
  alarm_.error_register = error_register;
  alarm_.confirmed = confirmed;
  if (alarm_.active) {
    const AlarmError& error = foremost(alarm_.errors);
    alarm_.code = error.code;
    alarm_.text = error.text;
    alarm_.severity = error.severity;
    alarm_.vendor = error.vendor;
    alarm_.reason = std::move(reason);
    alarm_.first = alarm_.first && alarm_.severity == config::Severity::fault;  // A warning is never first.
  }
  if (alarm_.active && !before.active) {
    ++alarm_.count;
    alarm_.id = new_id_();
    alarm_.since = now;
    alarm_.first = false;
    alarm_.record.clear();
  }
  fault_began_ = has_new_fault(before.errors, alarm_.errors);
  if (!alarm_.active && before.active) {
    alarm_.cleared = now;
  }
  if (alarm_ == before) {
    return false;
  }
  Alarm same = before;
  same.confirmed = alarm_.confirmed;
  // Whether it can be told is no change of it; nor is that there is none: it only became known.
  if (alarm_ != same && (before.known || alarm_.active)) {
    alarm_.ts = now;
  }
  return true;
}

bool AlarmRecord::set_first(bool first, canopen::WallTime now) {
  if (std::exchange(alarm_.first, first) == first) {
    return false;
  }
  alarm_.ts = now;
  return true;
}

bool AlarmRecord::set_record(std::string name) {
  return std::exchange(alarm_.record, name) != name;
}

bool AlarmRecord::show(bool active, std::string reason, std::string text, config::Severity severity,
                       canopen::WallTime now) {
  std::vector<AlarmError> errors;
  if (active) {
    errors.push_back({0, {}, std::move(text), severity, alarm_.active ? alarm_.since : now});
  }
  return show(std::move(errors), 0, true, now, std::move(reason));
}

void AlarmRecord::restore(const Alarm& before) {
  const bool never_was = !before.active && before.id.empty();
  const config::Severity severity = never_was ? alarm_.severity : before.severity;
  alarm_ = before;
  alarm_.severity = severity;
  alarm_.confirmed = false;
  alarm_.known = true;
}

}  // namespace alarms
