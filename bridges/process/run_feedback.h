#pragma once

#include <optional>

#include "bridges/process/control_use.h"
#include "canopen/clock.h"

namespace process {

/// Whether the motor followed a confirmed run command: `running` still false `feedback` after it is a failure. It ends
/// when `running` becomes true, with a confirmed stop, and with the session. Where nobody can tell whether the motor
/// turns, it waits until somebody can. A run command that is repeated while the first is awaited gives no more time.
class RunFeedback {
 public:
  /// `feedback` 0: nothing is awaited.
  explicit RunFeedback(canopen::Duration feedback) noexcept : feedback_(feedback) {}

  void on_confirmed(ControlUse use, canopen::TimePoint now);
  /// `running`: nothing where it is not fresh.
  void on_running(std::optional<bool> running, canopen::TimePoint now);
  void on_session_end() noexcept { end(); }
  void expire(canopen::TimePoint now);
  /// When expire() is to be called; kNever: not before something else happens.
  [[nodiscard]] canopen::TimePoint next_time() const noexcept { return running_ ? due_ : canopen::kNever; }

  [[nodiscard]] bool failed() const noexcept { return failed_; }

 private:
  void end() noexcept;

  canopen::Duration feedback_;
  std::optional<bool> running_;
  canopen::TimePoint due_ = canopen::kNever;
  bool failed_ = false;
};

}  // namespace process
