#pragma once

#include <optional>
#include <vector>

#include "bridges/mqtt/value_text.h"
#include "bridges/process/image.h"
#include "canopen/clock.h"
#include "config/model.h"

namespace mqtt {

/// Due before all that has a time.
inline constexpr canopen::TimePoint kAtOnce = canopen::TimePoint::min();

/// Decides when the values of one drive are published: when they changed by more than their deadband, not more often
/// than `min_interval`, at least every `max_interval` and before they expire; booleans, enumerations and the coming and
/// going of freshness at once. Holds no value itself but the last published one of each signal.
class Pace {
 public:
  Pace(const config::Drive& drive, const config::Mqtt& settings);

  /// What a signal is now. Returns when something of it is due, kAtOnce where that must not wait; kNever where nothing
  /// is.
  canopen::TimePoint note(process::SignalId signal, canopen::Raw raw, bool fresh);
  /// Something of the state message but a value changed: it is due at once.
  void note_state() noexcept { state_urgent_ = true; }
  /// Nothing counts as published any more: all is due at once.
  void forget();

  /// A boolean or a name changed since collected().
  [[nodiscard]] bool has_switched() const noexcept { return switched_; }
  /// All that is due was told.
  void collected() noexcept { switched_ = false; }
  [[nodiscard]] bool signal_due(process::SignalId signal, canopen::TimePoint now) const;
  [[nodiscard]] bool state_due(canopen::TimePoint now) const;
  void published_signal(process::SignalId signal, canopen::Raw raw, bool fresh, canopen::TimePoint now);
  void published_state(canopen::TimePoint now);
  /// When the next of them is due.
  [[nodiscard]] canopen::TimePoint next() const;

  [[nodiscard]] Shape shape(process::SignalId signal) const { return signals_.at(signal).shape; }

 private:
  struct Entry {
    Shape shape = Shape::number;
    bool readable = false;
    bool pending = false;
    bool urgent = false;
    bool fresh = false;
    canopen::Raw raw = 0;                  ///< As published.
    std::optional<canopen::TimePoint> at;  ///< Nothing: never published.
  };

  [[nodiscard]] bool changed(const Entry& entry, const config::Signal& signal, canopen::Raw raw, bool fresh) const;
  [[nodiscard]] canopen::TimePoint due(const Entry& entry) const;
  [[nodiscard]] canopen::TimePoint state_due_at() const;

  const config::Drive& drive_;
  const config::Mqtt& settings_;
  std::vector<Entry> signals_;
  bool state_pending_ = false;
  bool state_urgent_ = false;
  bool switched_ = false;
  std::optional<canopen::TimePoint> state_at_;
};

}  // namespace mqtt
