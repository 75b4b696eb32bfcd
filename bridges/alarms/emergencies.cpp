#include "bridges/alarms/emergencies.h"

#include <algorithm>
#include <utility>

#include "bridges/alarms/fault_naming.h"

namespace alarms {
namespace {

using canopen::Duration;
using canopen::TimePoint;
using canopen::WallTime;
using config::Severity;

/// A bit is believed without having been seen otherwise when it stays so for so many periods.
constexpr int kBelievedPeriods = 3;

std::uint16_t short_code(std::uint64_t code) noexcept {
  return code <= 0xFFFF ? static_cast<std::uint16_t>(code) : std::uint16_t{0};
}

bool has_vendor(const AlarmError& error) noexcept {
  return error.vendor != std::array<std::uint8_t, 5>{};
}

}  // namespace

Emergencies::Emergencies(const config::Drive& model) : model_(model) {}

bool Emergencies::on_emcy(const canopen::Emcy& emcy, TimePoint at, WallTime wall) {
  ++received_;
  error_register_ = emcy.error_register;
  evidence_ = true;
  if (!emcy.reset) {
    add(emcy, wall);
  } else if (emcy.remaining == 0 && emcy.error_register == 0) {
    clear_all(at);
  }
  return true;
}

void Emergencies::add(const canopen::Emcy& emcy, WallTime wall) {
  config::FaultText named = name_emcy(model_.faults, model_.node.emcy, emcy);
  const auto same = std::find_if(entries_.begin(), entries_.end(), [&](const Entry& entry) {
    // What did not come by an emergency has no vendor bytes to compare.
    const bool bytes_count =
        entry.origin == Origin::emcy || (entry.origin == Origin::restored && has_vendor(entry.error));
    return entry.error.code == emcy.code && (!bytes_count || entry.error.vendor == emcy.vendor);
  });
  if (same != entries_.end()) {
    same->error.vendor = emcy.vendor;
    same->error.text = std::move(named.text);
    if (same->origin != Origin::emcy || same->tabled != named.severity) {
      same->error.severity = named.severity;  // Else the drive's bits may have said better.
      same->tabled = named.severity;
    }
    same->origin = Origin::emcy;
    same->drive_code = emcy.drive_code;
    same->seen_set = false;
    same->from_before = false;
    same->clear_since.reset();
    return;
  }
  WallTime since = wall;
  // The bit came first and this is its name.
  std::erase_if(entries_, [&](const Entry& entry) {
    const bool replaced = entry.origin == Origin::bit && entry.error.severity == named.severity;
    since = replaced ? entry.error.since : since;
    return replaced;
  });
  entries_.push_back({.error = {emcy.code, emcy.vendor, std::move(named.text), named.severity, since},
                      .origin = Origin::emcy,
                      .drive_code = emcy.drive_code,
                      .tabled = named.severity});
  keep_few();
}

void Emergencies::keep_few() {
  while (entries_.size() > kMaxErrors) {
    const auto warning = std::find_if(entries_.begin(), entries_.end(),
                                      [](const Entry& entry) { return entry.error.severity == Severity::warning; });
    entries_.erase(warning != entries_.end() ? warning : entries_.begin());
  }
}

void Emergencies::clear_all(TimePoint at) {
  entries_.clear();
  for (Bit& bit : bits_) {
    bit.reset_at = bit.set ? std::optional(at) : std::nullopt;
  }
}

bool Emergencies::on_bit(Severity severity, bool set, Duration period, TimePoint at, WallTime wall) {
  return set ? on_bit_set(severity, period, at, wall) : on_bit_clear(severity, period, at);
}

bool Emergencies::on_bit_set(Severity severity, Duration period, TimePoint at, WallTime wall) {
  Bit& state = bit(severity);
  if (!state.set) {
    state.reset_at.reset();
  }
  state.known = true;
  state.set = true;
  for (Entry& entry : entries_) {
    if (entry.error.severity == severity) {
      entry.seen_set = true;
      entry.clear_since.reset();
    }
  }
  if (has(severity)) {
    const bool another = severity == Severity::fault && another_fault();
    if (another) {
      raise_from_bit(severity, wall);
      keep_few();
    }
    return !std::exchange(evidence_, true) || another;
  }
  if (state.reset_at && at - *state.reset_at < kBelievedPeriods * period) {
    return false;
  }
  state.reset_at.reset();
  evidence_ = true;
  if (!adopt(severity)) {
    raise_from_bit(severity, wall);
  }
  return true;
}

bool Emergencies::on_bit_clear(Severity severity, Duration period, TimePoint at) {
  bit(severity) = {.known = true, .set = false};
  const std::size_t removed = std::erase_if(entries_, [&](Entry& entry) {
    if (entry.error.severity != severity) {
      return false;
    }
    entry.clear_since = entry.clear_since.value_or(at);
    return entry.seen_set || at - *entry.clear_since >= kBelievedPeriods * period;
  });
  return removed > 0;
}

// A sample from before the fault bit followed may have made a fault a warning: then it goes back.
bool Emergencies::adopt(Severity severity) {
  const Bit& other = bit(severity == Severity::fault ? Severity::warning : Severity::fault);
  const bool alone = other.known && !other.set;
  const bool needed_as_fault = severity == Severity::warning && other.set;
  bool any = false;
  for (Entry& entry : entries_) {
    const bool its_own = entry.tabled == severity && !needed_as_fault;
    if (entry.origin == Origin::emcy && ((alone && !entry.seen_set) || its_own)) {
      entry.error.severity = severity;
      entry.seen_set = true;
      entry.clear_since.reset();
      any = true;
    }
  }
  return any;
}

void Emergencies::raise_from_bit(Severity severity, WallTime wall) {
  const std::uint64_t code = code_for(severity);
  entries_.push_back({.error = {short_code(code),
                                {},
                                name_fault_code(model_.faults, model_.node.emcy, code, severity).text,
                                severity,
                                wall},
                      .origin = Origin::bit,
                      .drive_code = code,
                      .seen_set = true});
}

// What was active may have been reset and another fault come while nobody listened. The old one is listed until the bit
// tells: the drive may have both.
bool Emergencies::another_fault() const noexcept {
  const auto known = model_.faults.drive_texts.find(fault_code_);
  const bool may_warn = !bit(Severity::warning).known || bit(Severity::warning).set;
  const bool names_warning =
      may_warn && known != model_.faults.drive_texts.end() && known->second.severity == Severity::warning;
  const bool of_emcy = is_emcy_code(model_.faults, model_.node.emcy, fault_code_);
  return fault_code_ != 0 && !names_warning && std::all_of(entries_.begin(), entries_.end(), [&](const Entry& entry) {
           // Without a number to compare it may be the same.
           const bool comparable = entry.drive_code.value_or(0) != 0 || of_emcy;
           return entry.error.severity != Severity::fault ||
                  (entry.from_before && comparable && !names(entry, fault_code_));
         });
}

std::uint64_t Emergencies::code_for(Severity severity) const noexcept {
  if (severity == Severity::fault) {
    return fault_code_;
  }
  // The code of a fault must not name a warning beside it.
  const auto known = model_.faults.drive_texts.find(fault_code_);
  const bool no_fault = bit(Severity::fault).known && !bit(Severity::fault).set;
  const bool names_fault =
      !no_fault && known != model_.faults.drive_texts.end() && known->second.severity == Severity::fault;
  const bool taken = std::any_of(entries_.begin(), entries_.end(), [&](const Entry& entry) {
    return entry.error.severity == Severity::fault && names(entry, fault_code_);
  });
  return names_fault || taken ? 0 : fault_code_;
}

bool Emergencies::on_fault_code(std::uint64_t code) {
  if (std::exchange(fault_code_, code) == code || code == 0) {
    return false;
  }
  bool changed = false;
  for (Entry& entry : entries_) {
    const std::uint64_t suited = code_for(entry.error.severity);
    if (entry.origin == Origin::bit && suited != 0 && entry.drive_code != suited) {
      entry.error.code = short_code(suited);
      entry.error.text = name_fault_code(model_.faults, model_.node.emcy, suited, entry.error.severity).text;
      entry.drive_code = suited;
      changed = true;
    }
  }
  return changed;
}

bool Emergencies::on_readings(const ErrorReadings& readings, TimePoint at, WallTime wall) {
  if (readings.fault_code) {
    on_fault_code(*readings.fault_code);
  }
  if (!readings.error_register) {
    return true;
  }
  error_register_ = *readings.error_register;
  evidence_ = true;
  if (error_register_ != 0) {
    raise_from_readings(readings, wall);
    return true;
  }
  // An error that its bit shows at this moment would only come back at once.
  std::vector<Entry> shown;
  std::copy_if(entries_.begin(), entries_.end(), std::back_inserter(shown),
               [&](const Entry& entry) { return entry.origin == Origin::bit && bit(entry.error.severity).set; });
  clear_all(at);
  entries_ = std::move(shown);
  return true;
}

void Emergencies::raise_from_readings(const ErrorReadings& readings, WallTime wall) {
  const std::uint64_t code = readings.fault_code.value_or(0);
  const bool named = code != 0 && std::any_of(entries_.begin(), entries_.end(),
                                              [&](const Entry& entry) { return names(entry, code); });
  if (named) {
    return;
  }
  if (code == 0 && !entries_.empty()) {
    name_by_history(readings.history.value_or(0));
    return;
  }
  const Bit& fault = bit(Severity::fault);
  const Severity severity = fault.known && !fault.set ? Severity::warning : Severity::fault;
  entries_.push_back({.error = {short_code(code),
                                {},
                                name_fault_code(model_.faults, model_.node.emcy, code, severity).text,
                                severity,
                                wall},
                      .origin = Origin::error_register,
                      .drive_code = code});
  keep_few();
  name_by_history(code == 0 ? readings.history.value_or(0) : std::uint16_t{0});
}

// The history only names: it may be of an error long gone.
void Emergencies::name_by_history(std::uint16_t code) {
  for (Entry& entry : entries_) {
    if (code != 0 && entry.drive_code == 0U && entry.error.code == 0) {
      entry.error.code = code;
      entry.error.text = name_history_code(model_.faults, model_.node.emcy, code, entry.error.severity).text;
    }
  }
}

bool Emergencies::on_online(bool online) {
  if (std::exchange(online_, online) == online) {
    return false;
  }
  if (!online) {
    evidence_ = false;
    bits_ = {};
    fault_code_ = 0;
    for (Entry& entry : entries_) {
      entry.clear_since.reset();
      entry.from_before = true;
    }
  }
  return true;
}

void Emergencies::restore(const Alarm& before) {
  error_register_ = before.error_register;
  for (const AlarmError& error : before.errors) {
    entries_.push_back({.error = error,
                        .origin = Origin::restored,
                        .drive_code = drive_code_of(model_.node.emcy, error),
                        .tabled = error.severity,
                        .from_before = true});
  }
  keep_few();
}

std::vector<AlarmError> Emergencies::errors() const {
  std::vector<AlarmError> errors;
  errors.reserve(entries_.size());
  for (const Entry& entry : entries_) {
    errors.push_back(entry.error);
  }
  return errors;
}

bool Emergencies::undecided(Severity severity) const noexcept {
  const bool waits = std::any_of(entries_.begin(), entries_.end(), [&](const Entry& entry) {
    return entry.error.severity == severity && !entry.seen_set;
  });
  return waits || bit(severity).reset_at.has_value();
}

bool Emergencies::has(Severity severity) const noexcept {
  return std::any_of(entries_.begin(), entries_.end(),
                     [&](const Entry& entry) { return entry.error.severity == severity; });
}

bool Emergencies::names(const Entry& entry, std::uint64_t fault_code) const noexcept {
  return entry.drive_code == fault_code || entry.error.code == fault_code;
}

}  // namespace alarms
