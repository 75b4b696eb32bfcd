#include "bridges/alarms/error_list.h"

#include <algorithm>
#include <utility>

#include "bridges/alarms/fault_naming.h"

namespace alarms {
namespace {

using canopen::Duration;
using canopen::TimePoint;
using canopen::WallTime;
using config::Severity;

/// A signal is believed without having been seen otherwise when it stays so for so many periods.
constexpr int kBelievedPeriods = 3;

/// Only what is read of 0x1001 after `at` counts for this error.
void read_again_after(ErrorEntry& entry, TimePoint at) {
  entry.error_register.reset();
  entry.counts_from = at;
  entry.verdict = ErrorVerdict::active;  // Undecided anew, so that it is asked for soon.
}

/// Within it an emergency is that of a signal that was seen before it; later it is another error, unless it has the
/// same number. A drive's fault code may still be that of the last fault when its signal comes.
constexpr Duration kFollows = std::chrono::seconds(2);

bool is_name_of(const ErrorEntry& emergency, const ErrorEntry& told_by_signal) noexcept {
  const std::uint64_t number = told_by_signal.drive_code.value_or(0);
  return emergency.at - told_by_signal.at <= kFollows ||
         (number != 0 && (emergency.drive_code == number || emergency.error.code == number));
}

}  // namespace

ErrorList::ErrorList(const config::Drive& model) : model_(model), names_(model, signals_) {}

bool ErrorList::on_emcy(const canopen::Emcy& emcy, TimePoint at, WallTime wall) {
  ++received_;
  error_register_ = emcy.error_register;
  evidence_ = true;
  if (!emcy.reset) {
    add(emcy, at, wall);
    judge(at);
    return true;
  }
  const ErrorReset reset{emcy.error_register, emcy.remaining};
  judge(at, reset);
  if (is_all_clear(reset)) {
    for (const Severity severity : {Severity::warning, Severity::fault}) {
      signals_[severity].reset_at = signals_.is_set(severity) ? std::optional(at) : std::nullopt;
    }
  }
  return true;
}

void ErrorList::add(const canopen::Emcy& emcy, TimePoint at, WallTime wall) {
  config::FaultText named = name_emcy(model_.faults, model_.node.emcy, emcy);
  ErrorEntry entry{.error = {emcy.code, emcy.vendor, std::move(named.text), named.severity, wall},
                   .drive_code = emcy.drive_code,
                   .tabled = named.severity,
                   .at = at,
                   .communication = is_communication(emcy.code),
                   .counts_from = at,
                   .undecided_since = at};
  if (ErrorEntry* const same = find_same(entries_, emcy.code, emcy.vendor)) {
    if (same->source == ErrorSource::emergency && same->tabled == named.severity) {
      entry.error.severity = same->error.severity;  // The drive's signals may have said better.
    }
    entry.error.since = same->error.since;
    entry.at = same->at;
    *same = std::move(entry);
    return;
  }
  // The signal came first and this is its name.
  std::erase_if(entries_, [&](const ErrorEntry& old) {
    const bool replaced =
        old.source == ErrorSource::signal && old.error.severity == named.severity && is_name_of(entry, old);
    if (replaced) {
      entry.error.since = old.error.since;
      entry.at = old.at;
    }
    return replaced;
  });
  push(std::move(entry));
}

void ErrorList::push(ErrorEntry entry) {
  entries_.push_back(std::move(entry));
  while (entries_.size() > kMaxErrors) {
    const auto warning = std::find_if(entries_.begin(), entries_.end(),
                                      [](const ErrorEntry& old) { return old.error.severity == Severity::warning; });
    entries_.erase(warning != entries_.end() ? warning : entries_.begin());
  }
}

bool ErrorList::on_signal(Severity severity, bool set, Duration period, TimePoint at, WallTime wall) {
  return set ? on_set(severity, period, at, wall) : on_clear(severity, period, at);
}

bool ErrorList::on_set(Severity severity, Duration period, TimePoint at, WallTime wall) {
  SignalState& state = signals_[severity];
  if (!state.set) {
    state.reset_at.reset();
  }
  state.known = true;
  state.set = true;
  note_set(severity, at);
  bool changed = false;
  if (has(severity)) {
    changed = !std::exchange(evidence_, true);
    if (severity == Severity::fault && names_.is_another_fault(entries_)) {
      raise_from_signal(severity, at, wall);
      changed = true;
    }
  } else if (!state.reset_at || at - *state.reset_at >= kBelievedPeriods * period) {
    state.reset_at.reset();
    evidence_ = true;
    changed = true;
    if (names_.claim(severity, entries_)) {
      note_set(severity, at);
    } else {
      raise_from_signal(severity, at, wall);
    }
  }
  judge(at);
  return changed;
}

void ErrorList::note_set(Severity severity, TimePoint at) {
  for (ErrorEntry& entry : entries_) {
    if (entry.error.severity == severity) {
      entry.seen_set = true;
      entry.clear_since.reset();
      entry.clear_three_periods = false;
      read_again_after(entry, at);
    }
  }
}

bool ErrorList::on_clear(Severity severity, Duration period, TimePoint at) {
  signals_[severity] = {.known = true, .set = false};
  for (ErrorEntry& entry : entries_) {
    if (entry.error.severity != severity) {
      continue;
    }
    const bool first = !entry.clear_since;
    entry.clear_since = entry.clear_since.value_or(at);
    const bool long_since = at - *entry.clear_since >= kBelievedPeriods * period;
    const bool now_long = long_since && !std::exchange(entry.clear_three_periods, long_since);
    // What was read before the signal told the end may be as old as the error.
    if (entry.seen_set ? first : now_long) {
      read_again_after(entry, at);
    }
  }
  return judge(at);
}

void ErrorList::on_stale_signal(Severity severity, TimePoint at) {
  signals_[severity].known = false;
  signals_[severity].set = false;
  for (ErrorEntry& entry : entries_) {
    if (entry.error.severity == severity) {
      entry.clear_since.reset();
      entry.clear_three_periods = false;
      read_again_after(entry, at);
    }
  }
  judge(at);
}

void ErrorList::raise_from_signal(Severity severity, TimePoint at, WallTime wall) {
  const std::uint64_t code = names_.code_for(severity, entries_);
  push({.error = error_of_code(model_, code, severity, wall),
        .drive_code = code,
        .at = at,
        .source = ErrorSource::signal,
        .seen_set = true,
        .counts_from = at});
}

bool ErrorList::on_fault_code(std::uint64_t code) {
  return names_.on_fault_code(code, entries_);
}

bool ErrorList::on_readings(const ErrorReadings& readings, TimePoint at, WallTime wall) {
  if (readings.fault_code) {
    names_.on_fault_code(*readings.fault_code, entries_);
  }
  take_register(readings);
  judge(at);
  if (readings.error_register.value_or(0) != 0 && model_.faults.error_register_follows) {
    raise_from_readings(readings, at, wall);
    judge(at);
  }
  return true;
}

bool ErrorList::on_error_register(const ErrorReadings& readings, TimePoint at) {
  take_register(readings);
  judge(at);
  return true;
}

void ErrorList::take_register(const ErrorReadings& readings) {
  register_absent_ = register_absent_ || readings.register_absent;
  if (!readings.error_register) {
    return;
  }
  error_register_ = *readings.error_register;
  evidence_ = evidence_ || model_.faults.error_register_follows;
  for (ErrorEntry& entry : entries_) {
    if (readings.asked >= entry.counts_from) {
      entry.error_register = readings.error_register;
    }
  }
}

// 0x1001 tells that there is an error, not which one.
void ErrorList::raise_from_readings(const ErrorReadings& readings, TimePoint at, WallTime wall) {
  const std::uint64_t code = readings.fault_code.value_or(0);
  const bool named = code != 0 && std::any_of(entries_.begin(), entries_.end(),
                                              [code](const ErrorEntry& entry) { return is_named(entry, code); });
  if (named) {
    return;
  }
  const bool no_fault = signals_.is_clear(Severity::fault);
  // Another one beside those that are known, whose emergency was lost: not where the fault signal tells of none.
  if (entries_.empty() || (code != 0 && !no_fault)) {
    const Severity severity = no_fault ? Severity::warning : Severity::fault;
    push({.error = error_of_code(model_, code, severity, wall),
          .drive_code = code,
          .at = at,
          .source = ErrorSource::error_register,
          .error_register = readings.error_register,
          .counts_from = at,
          .undecided_since = at});
  }
  if (code == 0) {
    names_.on_history(readings.history.value_or(0), entries_);
  }
}

bool ErrorList::on_boot_up(TimePoint at) {
  for (ErrorEntry& entry : entries_) {
    entry.before_boot_up = true;
  }
  return judge(at);
}

bool ErrorList::on_online(bool online) {
  if (std::exchange(online_, online) == online) {
    return false;
  }
  if (online) {
    return true;
  }
  evidence_ = false;
  register_absent_ = false;
  signals_ = {};
  names_.forget();
  for (ErrorEntry& entry : entries_) {
    entry.clear_since.reset();
    entry.clear_three_periods = false;
    entry.error_register.reset();
    entry.from_before = true;
    entry.verdict = ErrorVerdict::active;  // Its minute of frequent readings begins with its return.
  }
  return true;
}

void ErrorList::restore(const Alarm& before) {
  error_register_ = before.error_register;
  for (const AlarmError& error : before.errors) {
    push({.error = error,
          .drive_code = drive_code_of(model_.node.emcy, error),
          .tabled = error.severity,
          .from_before = true,
          .source = ErrorSource::memory,
          .communication = is_communication(error.code)});
  }
}

std::vector<AlarmError> ErrorList::errors() const {
  std::vector<AlarmError> errors;
  errors.reserve(entries_.size());
  for (const ErrorEntry& entry : entries_) {
    errors.push_back(entry.error);
  }
  return errors;
}

}  // namespace alarms
