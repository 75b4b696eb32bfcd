#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "bridges/alarms/alarm.h"
#include "canopen/clock.h"
#include "canopen/node/emcy.h"
#include "config/model.h"

namespace alarms {

/// What an arriving drive was found to hold. Nothing where an object is absent or did not answer.
struct ErrorReadings {
  std::optional<std::uint8_t> error_register;  ///< 0x1001
  std::optional<std::uint64_t> fault_code;     ///< The profile's fault code signal.
  std::optional<std::uint16_t> history;        ///< EMCY code of 0x1003:01, the newest of the drive's error history.
};

/// Which errors of one drive are active, from its emergencies, its fault and warning bits and 0x1001. The rules:
///  - an emergency makes an error active, one by code and vendor bytes; a reset that leaves none makes all of them go.
///    A partial reset does not tell which error went, so all stay;
///  - a fault or warning bit makes the errors of its severity go when it is received clear after it was seen set, or
///    after it stayed clear for three periods; it never takes away an error whose emergency is newer than the value;
///  - a bit that is set without such an emergency is an error itself, named by the fault code. After a reset a bit
///  still
///    set is believed only when it stays so for three periods: it may be older than the reset;
///  - 0x1001, read when a drive arrives: 0 makes all go, another value is an error even where none is known;
///  - while the drive is offline nothing changes and nothing is confirmed. What was known before and can be decided
///    neither by a bit nor by 0x1001 stays, unconfirmed, until an emergency tells more.
/// Functions return true where something may look different now.
class Emergencies {
 public:
  /// Errors kept at once. Some drives put something that changes all the time into the vendor bytes; the oldest goes
  /// then, a warning before a fault.
  static constexpr std::size_t kMaxErrors = 32;

  /// `model` outlives it.
  explicit Emergencies(const config::Drive& model);

  bool on_emcy(const canopen::Emcy& emcy, canopen::TimePoint at, canopen::WallTime wall);
  /// The bit for errors of this severity was received; `period` is that of its source.
  bool on_bit(config::Severity severity, bool set, canopen::Duration period, canopen::TimePoint at,
              canopen::WallTime wall);
  bool on_fault_code(std::uint64_t code);
  bool on_readings(const ErrorReadings& readings, canopen::TimePoint at, canopen::WallTime wall);
  bool on_online(bool online);
  /// What was known before the gateway's start. Before anything else.
  void restore(const Alarm& before);

  [[nodiscard]] std::vector<AlarmError> errors() const;
  [[nodiscard]] std::uint8_t error_register() const noexcept { return error_register_; }
  /// The drive could tell whether the errors still hold.
  [[nodiscard]] bool confirmed() const noexcept { return online_ && (entries_.empty() || evidence_); }
  /// Another value of this bit would tell more.
  [[nodiscard]] bool undecided(config::Severity severity) const noexcept;
  /// Grows with each emergency: what was asked for before and answered after one is out of date.
  [[nodiscard]] std::uint32_t received() const noexcept { return received_; }

 private:
  enum class Origin : std::uint8_t { emcy, bit, error_register, restored };
  struct Entry {
    AlarmError error;
    Origin origin = Origin::emcy;
    std::optional<std::uint64_t> drive_code;
    config::Severity tabled = config::Severity::fault;  ///< What its text's table says; the drive's bits know better.
    bool seen_set = false;                              ///< Its bit was received set after its emergency.
    bool from_before = false;                           ///< From before the drive came online.
    std::optional<canopen::TimePoint> clear_since{};    ///< Since when its bit is received clear.
  };
  struct Bit {
    bool known = false;
    bool set = false;
    std::optional<canopen::TimePoint> reset_at{};  ///< A reset came while it was set.
  };

  [[nodiscard]] Bit& bit(config::Severity severity) noexcept { return bits_[static_cast<std::size_t>(severity)]; }
  [[nodiscard]] const Bit& bit(config::Severity severity) const noexcept {
    return bits_[static_cast<std::size_t>(severity)];
  }
  [[nodiscard]] bool has(config::Severity severity) const noexcept;
  [[nodiscard]] bool names(const Entry& entry, std::uint64_t fault_code) const noexcept;
  void add(const canopen::Emcy& emcy, canopen::WallTime wall);
  void keep_few();
  void clear_all(canopen::TimePoint at);
  bool on_bit_set(config::Severity severity, canopen::Duration period, canopen::TimePoint at, canopen::WallTime wall);
  bool on_bit_clear(config::Severity severity, canopen::Duration period, canopen::TimePoint at);
  /// The bit of this severity is set and no error has it: emergencies of the other are of this one where their own bit
  /// was never seen set, or where the table says so. False: none.
  bool adopt(config::Severity severity);
  void raise_from_bit(config::Severity severity, canopen::WallTime wall);
  void raise_from_readings(const ErrorReadings& readings, canopen::WallTime wall);
  void name_by_history(std::uint16_t code);
  /// The fault code names none of the faults, and all of them are from before the drive came online.
  [[nodiscard]] bool another_fault() const noexcept;
  [[nodiscard]] std::uint64_t code_for(config::Severity severity) const noexcept;

  const config::Drive& model_;
  std::vector<Entry> entries_;  ///< Oldest first.
  std::array<Bit, 2> bits_{};
  std::uint64_t fault_code_ = 0;
  std::uint32_t received_ = 0;
  std::uint8_t error_register_ = 0;
  bool online_ = false;
  bool evidence_ = false;
};

}  // namespace alarms
