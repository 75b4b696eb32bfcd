#include "bridges/alarms/error_decision.h"

namespace alarms {
namespace {

using Register = RegisterWitness::State;

/// 0x1001: generic error, which is set with each of the others, and communication (CiA 301 §7.5.2.2).
constexpr unsigned kCommunicationBits = 0x11;

/// A status word does not show communication errors: it is clean while they last. What the signal itself has told, it
/// has shown.
bool signal_may_end(const ErrorFacts& facts) noexcept {
  return !facts.communication || facts.source == ErrorSource::signal;
}

/// What is left of 0x1001 belongs to the communication error beside this one.
bool is_explained(const ErrorFacts& facts) noexcept {
  return facts.other_communication && (facts.error_register.value & ~kCommunicationBits) == 0;
}

/// A drive that boots is free of errors (CiA 301 §7.2.7.1, transition 0) and tells anew of those it has. That has to do
/// where nothing else can tell the end.
bool is_forgotten(const ErrorFacts& facts) noexcept {
  return facts.before_boot_up && (facts.signal == ErrorSignal::none || !signal_may_end(facts));
}

}  // namespace

bool is_all_clear(const ErrorReset& reset) noexcept {
  return reset.error_register == 0 && reset.remaining == 0;
}

bool signal_tells_end(const ErrorFacts& facts) noexcept {
  return facts.signal == ErrorSignal::clear && (facts.seen_set || facts.clear_three_periods) && signal_may_end(facts);
}

ErrorVerdict decide(const ErrorFacts& facts) noexcept {
  if (facts.reset && is_all_clear(*facts.reset)) {
    return ErrorVerdict::over;
  }
  if (facts.signal == ErrorSignal::set) {
    return ErrorVerdict::active;  // Ended by anything else it would only be raised again.
  }
  const bool told = signal_tells_end(facts);
  switch (facts.error_register.state) {
    case Register::absent:
    case Register::independent:
      return told || is_forgotten(facts) ? ErrorVerdict::over : ErrorVerdict::active;
    case Register::read:
      if (facts.error_register.value == 0 || (told && is_explained(facts))) {
        return ErrorVerdict::over;
      }
      break;
    case Register::not_read:
      break;
  }
  // Within three periods the signal tells more than 0x1001 could.
  const bool waits_for_signal = facts.signal == ErrorSignal::clear && signal_may_end(facts) && !told;
  return waits_for_signal ? ErrorVerdict::active : ErrorVerdict::undecided;
}

}  // namespace alarms
