#include <algorithm>

#include "bridges/alarms/error_list.h"

namespace alarms {

using canopen::TimePoint;
using config::Severity;

bool ErrorList::has(Severity severity) const noexcept {
  return std::any_of(entries_.begin(), entries_.end(),
                     [severity](const ErrorEntry& entry) { return entry.error.severity == severity; });
}

bool ErrorList::is_communication(std::uint16_t code) const noexcept {
  constexpr std::uint16_t kClassMask = 0xF000;
  constexpr std::uint16_t kMonitoring = 0x8000;  // CiA 301 table 26: 0x81xx communication, 0x82xx protocol.
  return model_.node.emcy.layout != canopen::EmcyLayout::drive_code && (code & kClassMask) == kMonitoring;
}

ErrorSignal ErrorList::signal_of(Severity severity) const noexcept {
  const SignalState& state = signals_[severity];
  if (state.known) {
    return state.set ? ErrorSignal::set : ErrorSignal::clear;
  }
  const config::FaultRules& faults = model_.faults;
  return severity == Severity::fault ? (faults.fault ? ErrorSignal::unknown : ErrorSignal::none)
                                     : (faults.warning ? ErrorSignal::unknown : ErrorSignal::none);
}

RegisterWitness ErrorList::witness(const ErrorEntry& entry) const noexcept {
  if (!model_.faults.error_register_follows) {
    return {.state = RegisterWitness::State::independent};
  }
  if (register_absent_ || !model_.faults.has_error_register) {
    return {.state = RegisterWitness::State::absent};
  }
  if (!entry.error_register) {
    return {};
  }
  return {.state = RegisterWitness::State::read, .value = *entry.error_register};
}

ErrorFacts ErrorList::facts_of(const ErrorEntry& entry) const noexcept {
  const bool other = std::any_of(entries_.begin(), entries_.end(),
                                 [&](const ErrorEntry& listed) { return &listed != &entry && listed.communication; });
  return {.source = entry.source,
          .communication = entry.communication,
          .reset = std::nullopt,
          .signal = signal_of(entry.error.severity),
          .seen_set = entry.seen_set,
          .clear_three_periods = entry.clear_three_periods,
          .error_register = witness(entry),
          .before_boot_up = entry.before_boot_up,
          .other_communication = other};
}

bool ErrorList::judge(TimePoint at, std::optional<ErrorReset> reset) {
  for (ErrorEntry& entry : entries_) {
    ErrorFacts facts = facts_of(entry);
    facts.reset = reset;
    const ErrorVerdict verdict = decide(facts);
    if (verdict == ErrorVerdict::undecided && entry.verdict != verdict) {
      entry.undecided_since = at;
    }
    entry.verdict = verdict;
  }
  return std::erase_if(entries_, [](const ErrorEntry& entry) { return entry.verdict == ErrorVerdict::over; }) > 0;
}

bool ErrorList::awaits_signal(Severity severity) const noexcept {
  const bool waits = std::any_of(entries_.begin(), entries_.end(), [&](const ErrorEntry& entry) {
    return entry.error.severity == severity && !entry.communication && !entry.seen_set && !entry.clear_three_periods;
  });
  return waits || signals_[severity].reset_at.has_value();
}

std::optional<TimePoint> ErrorList::undecided_since() const noexcept {
  std::optional<TimePoint> since;
  for (const ErrorEntry& entry : entries_) {
    if (online_ && entry.verdict == ErrorVerdict::undecided) {
      since = std::max(since.value_or(entry.undecided_since), entry.undecided_since);
    }
  }
  return since;
}

}  // namespace alarms
