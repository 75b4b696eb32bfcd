#pragma once

#include <cstdint>
#include <optional>

namespace alarms {

/// Who told of an error.
enum class ErrorSource : std::uint8_t {
  emergency,       ///< An EMCY.
  signal,          ///< The profile's fault or warning signal, without an EMCY.
  error_register,  ///< 0x1001, found not to be 0.
  memory           ///< Known from before the gateway's start.
};

/// The signal of the error's severity.
enum class ErrorSignal : std::uint8_t {
  none,     ///< The profile has none.
  unknown,  ///< Not received since the drive came.
  set,
  clear
};

/// What an EMCY with code 0x0000 said (CiA 301 §7.2.7.1).
struct ErrorReset {
  std::uint8_t error_register = 0;  ///< Its byte 2.
  std::uint8_t remaining = 0;       ///< Error sources that remain, where the layout counts them; else 0.
};

/// 0x1001 as a witness of one error.
struct RegisterWitness {
  enum class State : std::uint8_t {
    not_read,     ///< Not since the error was told, nor since its signal told its end.
    read,         ///< Since both.
    absent,       ///< The drive has none.
    independent,  ///< The profile says that it does not follow the faults.
  };
  State state = State::not_read;
  std::uint8_t value = 0;  ///< Where it was read.
  friend bool operator==(const RegisterWitness&, const RegisterWitness&) = default;
};

/// All that decides whether one error is active. Its name is not among it.
struct ErrorFacts {
  ErrorSource source = ErrorSource::emergency;
  bool communication = false;       ///< 0x8xxx in a layout whose codes are CiA's: see is_communication.
  std::optional<ErrorReset> reset;  ///< Received after the error was told.
  ErrorSignal signal = ErrorSignal::none;
  bool seen_set = false;             ///< The signal was received set after the error was told.
  bool clear_three_periods = false;  ///< The signal stayed clear for three periods since.
  RegisterWitness error_register;
  bool before_boot_up = false;       ///< Told before the drive's last boot-up message.
  bool other_communication = false;  ///< Another error is active that is a communication error.
};

enum class ErrorVerdict : std::uint8_t {
  active,     ///< And 0x1001 would not tell more now.
  undecided,  ///< Active as long as nothing else is known; 0x1001 is to be read.
  over
};

/// All errors have gone, as far as this reset tells. Lenze tells a partial one by a register that is not 0, OPTE6 by
/// its count.
[[nodiscard]] bool is_all_clear(const ErrorReset& reset) noexcept;

/// The signal told that the error is gone; whether that is enough is a matter of decide().
[[nodiscard]] bool signal_tells_end(const ErrorFacts& facts) noexcept;

/// Whether one error is active. docs/ALARMS.md says the same in words.
[[nodiscard]] ErrorVerdict decide(const ErrorFacts& facts) noexcept;

}  // namespace alarms
