#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "bridges/alarms/alarm.h"
#include "bridges/alarms/error_decision.h"
#include "canopen/clock.h"
#include "config/model.h"

namespace alarms {

/// One error of a drive, with what is known of it. The upper half decides nothing.
struct ErrorEntry {
  AlarmError error;
  std::optional<std::uint64_t> drive_code;            ///< The drive's own number of it.
  config::Severity tabled = config::Severity::fault;  ///< What its text's table says; the drive's signals know better.
  bool from_before = false;                           ///< From before the drive came online.
  canopen::TimePoint at = canopen::TimePoint::min();  ///< Kernel stamp of what told it first; min(): from memory.

  ErrorSource source = ErrorSource::emergency;
  bool communication = false;
  bool seen_set = false;
  std::optional<canopen::TimePoint> clear_since{};  ///< Since when its signal is received clear.
  bool clear_three_periods = false;
  std::optional<std::uint8_t> error_register{};  ///< 0x1001, asked for after `counts_from`.
  canopen::TimePoint counts_from = canopen::TimePoint::min();
  bool before_boot_up = false;
  ErrorVerdict verdict = ErrorVerdict::active;
  canopen::TimePoint undecided_since = canopen::TimePoint::min();
};
using ErrorEntries = std::vector<ErrorEntry>;  ///< Oldest first.

/// What was received of a fault or warning signal since the drive came.
struct SignalState {
  bool known = false;
  bool set = false;
  std::optional<canopen::TimePoint> reset_at{};  ///< A reset of all errors came while it was set.
};

/// By severity.
class SignalStates {
 public:
  [[nodiscard]] SignalState& operator[](config::Severity severity) noexcept {
    return states_[static_cast<std::size_t>(severity)];
  }
  [[nodiscard]] const SignalState& operator[](config::Severity severity) const noexcept {
    return states_[static_cast<std::size_t>(severity)];
  }
  [[nodiscard]] bool is_set(config::Severity severity) const noexcept { return (*this)[severity].set; }
  [[nodiscard]] bool is_clear(config::Severity severity) const noexcept {
    return (*this)[severity].known && !(*this)[severity].set;
  }

 private:
  std::array<SignalState, 2> states_{};
};

}  // namespace alarms
