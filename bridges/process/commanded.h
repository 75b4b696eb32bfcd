#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "bridges/process/image.h"
#include "bridges/process/write_plan.h"
#include "canopen/clock.h"
#include "canopen/object.h"
#include "config/model.h"

namespace process {

/// What one drive was commanded: the one owner of it. Whoever needs to know whether a value still stands asks here: the
/// completion and repetition of RPDOs, mask writes, command registers, the journal.
///
/// A value *counts* from its confirmation until something makes it void; only what counts may be sent again beside
/// something else. Void become
/// - `control_command`: at the begin and the end of a fault, at a quick stop, when the motor comes to a stop or nobody
///   can tell any more whether it turns;
/// - everything: at boot-up, loss and leaving operational;
/// - one field: when its outcome is unknown, and at once where the value is momentary (fault reset, jog).
/// So a set-point never carries a run command that nobody gave since.
class Commanded {
 public:
  /// Moments that make something void are counted; 0 is before all of them.
  using Epoch = std::uint32_t;

  /// `model` outlives it.
  explicit Commanded(const config::Drive& model);

  /// Last confirmed since the gateway's start, whether it still counts or not, else 0.
  [[nodiscard]] canopen::Raw shown(SignalId signal) const noexcept;
  [[nodiscard]] bool counts(SignalId signal) const noexcept;
  /// The value that counts.
  [[nodiscard]] std::optional<canopen::Raw> known(SignalId signal) const noexcept;
  /// What the drive holds by our commands, whether it counts or not: an edge that it shows already does nothing.
  [[nodiscard]] std::optional<canopen::Raw> held(SignalId signal) const noexcept;
  /// When the value that counts was confirmed.
  [[nodiscard]] std::optional<canopen::TimePoint> confirmed_at(SignalId signal) const noexcept;
  /// When a value was last confirmed, whether it still counts or not.
  [[nodiscard]] std::optional<canopen::TimePoint> last_confirmed_at(SignalId signal) const noexcept;
  /// A command of unknown outcome may have overwritten what was read from the drive until then.
  [[nodiscard]] std::optional<canopen::TimePoint> doubtful_at(SignalId signal) const noexcept;

  [[nodiscard]] Epoch epoch() const noexcept { return epoch_; }
  /// What made `control_command` void since; empty: nothing.
  [[nodiscard]] std::string_view control_void_since(Epoch epoch) const noexcept;
  /// What made everything void since; empty: nothing.
  [[nodiscard]] std::string_view all_void_since(Epoch epoch) const noexcept;

  /// These were confirmed, by RPDO `rpdo` or, 0, by SDO. `since`: the epoch when their frame was handed over; what
  /// became void after that does not count. `control_counts`: somebody can tell whether the motor turns.
  void confirm(std::span<const Field> fields, std::uint16_t rpdo, Epoch since, bool control_counts,
               canopen::TimePoint now);
  /// Nobody knows whether these took effect. Their RPDO is repeated no more, but for a stop that came after `since`.
  void doubt(std::span<const Field> fields, Epoch since, canopen::TimePoint now);

  void on_fault_begin(std::string_view what);
  void on_fault_end();
  /// A supervised RPDO goes on with a stop: the drive would trip otherwise.
  void on_standstill(std::string_view what);
  void on_session_end(std::string_view what);
  /// A stop is about to be sent: from now on what is repeated holds it, and no older control command counts.
  void on_stop(canopen::Raw control);

  // RPDOs.

  /// The RPDO that maps the signal's object as commanded; 0: none.
  [[nodiscard]] std::uint16_t rpdo_of(SignalId signal) const noexcept;
  /// The drive supervises the RPDO that maps it.
  [[nodiscard]] bool is_supervised(SignalId signal) const noexcept;
  /// Each commanded field of the RPDO, the given ones over what counts; nothing where one is missing, or a given one
  /// does not belong to it.
  [[nodiscard]] std::optional<std::vector<canopen::ObjectValue>> values(std::uint16_t rpdo,
                                                                        std::span<const Field> given) const;
  /// The commanded signals of the RPDO that are neither given nor count; nothing where it can never be complete.
  [[nodiscard]] std::optional<std::vector<SignalId>> missing(std::uint16_t rpdo, std::span<const Field> given) const;
  /// What the RPDO is to be repeated with; nothing: not at all.
  [[nodiscard]] std::optional<std::vector<canopen::ObjectValue>> repetition(std::uint16_t rpdo) const;
  /// The control command that a repeated RPDO holds: a stop that is about to be sent before what the drive is known to
  /// hold.
  [[nodiscard]] std::optional<canopen::Raw> repeated_control() const noexcept;

  /// `control_command`; nothing where the drive has none.
  [[nodiscard]] std::optional<SignalId> control() const noexcept { return control_; }
  [[nodiscard]] bool is_control(SignalId signal) const noexcept { return control_ && *control_ == signal; }
  /// The raw value only ever stops the motor.
  [[nodiscard]] bool is_stop(canopen::Raw control) const noexcept;

 private:
  struct Value {
    canopen::Raw shown = 0;
    std::optional<canopen::Raw> held{};
    bool counts = false;
    canopen::TimePoint confirmed{};
    std::optional<canopen::TimePoint> doubtful{};
  };
  /// A field of an RPDO that a writable signal names.
  struct MappedSignal {
    SignalId signal = 0;
    canopen::ObjectAddress object;
    canopen::DataType type = canopen::DataType::u16;
  };
  struct Rpdo {
    std::uint16_t number = 0;
    bool can_be_complete = true;  ///< None of its fields is unnamed.
    bool supervised = false;      ///< By the drive: it is repeated.
    bool repeats = false;
    std::vector<MappedSignal> fields;
  };
  struct Voided {
    Epoch epoch = 0;
    std::string what;
  };

  [[nodiscard]] static bool maps(const Rpdo& rpdo, SignalId signal) noexcept;
  [[nodiscard]] const Rpdo* find(std::uint16_t number) const noexcept;
  void void_control(std::string_view what);
  /// Nothing of before is repeated.
  void end_repetition();
  void note_repetition(const Field& field, Rpdo& rpdo, bool by_this_rpdo);
  /// What goes on being repeated after `control_command` became void.
  void replace_repeated_control(std::optional<canopen::Raw> stop);
  /// A control command was confirmed that came before a stop, or was void meanwhile, or neither.
  void note_confirmed_control(canopen::Raw raw, bool before_stop, bool outlived);
  [[nodiscard]] std::optional<canopen::Raw> control_held() const noexcept;
  /// It cannot start the motor, however often it is repeated.
  [[nodiscard]] bool may_go_on(canopen::Raw control) const noexcept;
  /// The RPDO may be repeated over the end of a fault where its control command, if it has one, is `control`.
  [[nodiscard]] bool outlasts_fault(const Rpdo& rpdo, std::optional<canopen::Raw> control) const noexcept;

  const config::Drive& model_;
  std::optional<SignalId> control_;
  std::vector<Value> values_;  ///< By signal.
  std::vector<Rpdo> rpdos_;
  Epoch epoch_ = 0;
  Voided control_void_;
  Voided all_void_;
  Epoch silenced_ = 0;                            ///< When repetition last had to end.
  Epoch fault_end_ = 0;                           ///< When a fault last ended.
  Epoch stopped_ = 0;                             ///< When the newest stop came.
  canopen::Raw stop_ = 0;                         ///< What it writes.
  std::optional<canopen::Raw> repeated_instead_;  ///< Repeated in place of the control command that the drive holds.
};

}  // namespace process
