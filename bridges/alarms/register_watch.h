#pragma once

#include <optional>

#include "canopen/clock.h"

namespace alarms {

/// When 0x1001 is to be read while an error is undecided: every second for a minute, then every 10 s. The minute starts
/// again with a new emergency, and with a further undecided error. A drive that did not answer twice in a row is asked
/// every 10 s only, until it does: each attempt keeps its SDO channel through all tries.
class RegisterWatch {
 public:
  /// An emergency came. The first reading after it waits a second: the register may follow the frame.
  void on_emergency(canopen::TimePoint at) noexcept;
  /// 0x1001 was asked for; `answered`: by a value or a refusal. The next attempt counts from here.
  void on_read(canopen::TimePoint at, bool answered) noexcept;
  /// The drive went away: another answers, perhaps.
  void forget_silence() noexcept { misses_ = 0; }
  /// Twice in a row it had no answer. Once may be a stop that cut the reading short.
  [[nodiscard]] bool silent() const noexcept { return misses_ >= 2; }

  /// `undecided_since`: when the last of the undecided errors became so; nothing: none is. canopen::kNever: not at all.
  [[nodiscard]] canopen::TimePoint next(std::optional<canopen::TimePoint> undecided_since) const noexcept;

 private:
  std::optional<canopen::TimePoint> emergency_;
  std::optional<canopen::TimePoint> waits_from_;  ///< The first emergency after the last reading.
  std::optional<canopen::TimePoint> read_;
  unsigned misses_ = 0;  ///< Attempts in a row without an answer.
};

}  // namespace alarms
