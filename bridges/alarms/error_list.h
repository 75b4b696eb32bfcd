#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "bridges/alarms/alarm.h"
#include "bridges/alarms/error_entry.h"
#include "bridges/alarms/error_names.h"
#include "canopen/clock.h"
#include "canopen/node/emcy.h"
#include "config/model.h"

namespace alarms {

/// What a drive was found to hold. Nothing where an object did not answer.
struct ErrorReadings {
  canopen::TimePoint asked = canopen::TimePoint::min();  ///< When 0x1001 was asked for.
  std::optional<std::uint8_t> error_register{};          ///< 0x1001
  bool register_absent = false;                          ///< The drive has no 0x1001.
  std::optional<std::uint64_t> fault_code{};             ///< The profile's fault code signal.
  std::optional<std::uint16_t> history{};  ///< EMCY code of 0x1003:01, the newest of the drive's error history.
};

/// The active errors of one drive. An emergency makes one, one by code and vendor bytes; so does a fault or warning
/// signal that is set without an emergency, and 0x1001 that is not 0 while no error is known. When one is over decides
/// error_decision.h, what it is called error_names.h; this keeps the facts of each. While the drive is offline nothing
/// changes and nothing is confirmed.
/// Functions return true where something may look different now. `at` is the kernel's stamp of what told it.
class ErrorList {
 public:
  /// Errors kept at once. Some drives put something that changes all the time into the vendor bytes; the oldest goes
  /// then, a warning before a fault.
  static constexpr std::size_t kMaxErrors = 32;

  /// `model` outlives it.
  explicit ErrorList(const config::Drive& model);
  ErrorList(const ErrorList&) = delete;
  ErrorList& operator=(const ErrorList&) = delete;

  bool on_emcy(const canopen::Emcy& emcy, canopen::TimePoint at, canopen::WallTime wall);
  /// The signal for errors of this severity was received; `period` is that of its source.
  bool on_signal(config::Severity severity, bool set, canopen::Duration period, canopen::TimePoint at,
                 canopen::WallTime wall);
  /// Its last value is too old to tell anything.
  void on_stale_signal(config::Severity severity, canopen::TimePoint at);
  bool on_fault_code(std::uint64_t code);
  /// All that is read when a drive arrives or frames were lost.
  bool on_readings(const ErrorReadings& readings, canopen::TimePoint at, canopen::WallTime wall);
  /// 0x1001 alone: it can end errors and raises none.
  bool on_error_register(const ErrorReadings& readings, canopen::TimePoint at);
  bool on_online(bool online);
  /// Its boot-up message came.
  bool on_boot_up(canopen::TimePoint at);
  /// What was known before the gateway's start. Before anything else.
  void restore(const Alarm& before);

  [[nodiscard]] std::vector<AlarmError> errors() const;
  [[nodiscard]] std::uint8_t error_register() const noexcept { return error_register_; }
  /// The drive could tell whether the errors still hold.
  [[nodiscard]] bool confirmed() const noexcept { return online_ && (entries_.empty() || evidence_); }
  /// Another value of this signal would tell more.
  [[nodiscard]] bool awaits_signal(config::Severity severity) const noexcept;
  /// When the last of those errors became undecided that only 0x1001 can decide; nothing: there are none.
  [[nodiscard]] std::optional<canopen::TimePoint> undecided_since() const noexcept;
  /// Grows with each emergency: what was asked for before and answered after one is out of date.
  [[nodiscard]] std::uint32_t received() const noexcept { return received_; }

 private:
  [[nodiscard]] bool has(config::Severity severity) const noexcept;
  [[nodiscard]] ErrorSignal signal_of(config::Severity severity) const noexcept;
  [[nodiscard]] RegisterWitness witness(const ErrorEntry& entry) const noexcept;
  [[nodiscard]] ErrorFacts facts_of(const ErrorEntry& entry) const noexcept;
  [[nodiscard]] bool is_communication(std::uint16_t code) const noexcept;
  /// Decides on each error; true where any is over.
  bool judge(canopen::TimePoint at, std::optional<ErrorReset> reset = std::nullopt);
  void add(const canopen::Emcy& emcy, canopen::TimePoint at, canopen::WallTime wall);
  void push(ErrorEntry entry);
  bool on_set(config::Severity severity, canopen::Duration period, canopen::TimePoint at, canopen::WallTime wall);
  bool on_clear(config::Severity severity, canopen::Duration period, canopen::TimePoint at);
  void note_set(config::Severity severity, canopen::TimePoint at);
  void raise_from_signal(config::Severity severity, canopen::TimePoint at, canopen::WallTime wall);
  void raise_from_readings(const ErrorReadings& readings, canopen::TimePoint at, canopen::WallTime wall);
  void take_register(const ErrorReadings& readings);

  const config::Drive& model_;
  ErrorEntries entries_;
  SignalStates signals_;
  ErrorNames names_;
  std::uint32_t received_ = 0;
  std::uint8_t error_register_ = 0;
  bool register_absent_ = false;
  bool online_ = false;
  bool evidence_ = false;
};

}  // namespace alarms
