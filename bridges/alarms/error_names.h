#pragma once

#include <cstdint>

#include "bridges/alarms/error_entry.h"
#include "canopen/clock.h"
#include "canopen/node/emcy.h"
#include "config/model.h"

namespace alarms {

// What errors are called, and which signal is theirs. Nothing here ends an error.

/// What an error told by a signal or by 0x1001 is called; `code` 0: nobody knows its number.
[[nodiscard]] AlarmError error_of_code(const config::Drive& model, std::uint64_t code, config::Severity severity,
                                       canopen::WallTime since);

[[nodiscard]] bool is_named(const ErrorEntry& entry, std::uint64_t fault_code) noexcept;

/// The same error, told by an emergency: one by code and vendor bytes. What did not come by an emergency has none to
/// compare. Null: none.
[[nodiscard]] ErrorEntry* find_same(ErrorEntries& entries, std::uint16_t code,
                                    const std::array<std::uint8_t, 5>& vendor) noexcept;

/// Names of a drive's errors out of its fault code and 0x1003, which may be of an error long gone.
class ErrorNames {
 public:
  /// `model` and `signals` outlive it.
  ErrorNames(const config::Drive& model, const SignalStates& signals) : model_(model), signals_(signals) {}

  /// The drive went away.
  void forget() noexcept { fault_code_ = 0; }
  /// True where a name changed.
  bool on_fault_code(std::uint64_t code, ErrorEntries& entries);
  void on_history(std::uint16_t code, ErrorEntries& entries) const;

  /// The fault code, as far as it can be that of an error which the signal of this severity tells.
  [[nodiscard]] std::uint64_t code_for(config::Severity severity, const ErrorEntries& entries) const noexcept;
  /// The fault signal is set, and the fault code names none of the faults, which are all from before the drive came.
  [[nodiscard]] bool is_another_fault(const ErrorEntries& entries) const noexcept;
  /// Gives emergencies to the signal of this severity, which is set and has no error: those whose own signal was never
  /// seen set, and those that the table counts to it. False: there are none.
  bool claim(config::Severity severity, ErrorEntries& entries) const noexcept;

 private:
  [[nodiscard]] bool tabled_as(config::Severity severity) const noexcept;

  const config::Drive& model_;
  const SignalStates& signals_;
  std::uint64_t fault_code_ = 0;
};

}  // namespace alarms
