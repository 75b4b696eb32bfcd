#pragma once

#include <optional>
#include <string>

#include "bridges/alarms/control_alarm.h"
#include "bridges/process/command_timeout.h"
#include "bridges/process/control_use.h"
#include "bridges/process/lease.h"
#include "bridges/process/run_feedback.h"
#include "bridges/process/writer.h"
#include "canopen/clock.h"

namespace process {

/// What the site says of one drive's writers; 0: off.
struct ControlSettings {
  canopen::Duration lease{};
  canopen::Duration timeout{};
  canopen::Duration feedback{};
  OnTimeout on_timeout = OnTimeout::hold;
};

/// What of it people see.
struct ControlState {
  std::optional<Writer> holder;  ///< Of the lease: register 1000 bit 7.
  canopen::WallTime since{};     ///< Since when; zero where nobody holds it.
  bool timeout = false;          ///< The command timeout has acted: register 1000 bit 6.
  std::optional<alarms::ControlAlarm> alarm;
  friend bool operator==(const ControlState&, const ControlState&) = default;
};

/// Who is in control of one drive: the lease, the writer's signs of life, and whether the motor follows. It knows no
/// bus and no timer: it is told what happens, and its owner calls expire() at next_time(). After each call of either
/// kind state() may have changed.
///
/// Of the reasons for the alarm a timeout goes before `feedback`.
class Control {
 public:
  explicit Control(const ControlSettings& settings) noexcept
      : lease_(settings.lease),
        timeout_(settings.timeout, settings.on_timeout),
        feedback_(settings.feedback),
        feedback_time_(settings.feedback) {}

  /// Why a command of `writer` is refused `lease`, for people. A stop never is.
  [[nodiscard]] std::optional<std::string> refuse(const Writer& writer, ControlUse use, canopen::TimePoint now) const {
    return lease_.refuse(writer, use, now);
  }

  /// A command passed all checks, whatever will become of it. Not for the timeout's own values.
  void on_accepted(const Writer& writer, ControlUse use, canopen::TimePoint now);
  /// `control_command` was confirmed, by a command of `writer` or by the timeout's own values (of any writer: those
  /// hold no run command).
  void on_confirmed_control(const Writer& writer, ControlUse use, canopen::TimePoint now);
  /// Of a writer that may command this drive: else a display that only reads would keep a drive running that was taken
  /// over.
  void on_sign_of_life(const Writer& writer, canopen::TimePoint now) { timeout_.on_sign_of_life(writer, now); }
  /// `running`: nothing where it is not fresh. To be told after on_taken_over(), too, where it was not known by then.
  void on_running(std::optional<bool> running, canopen::TimePoint now);
  /// The drive was found operational and not booted by us.
  void on_taken_over(std::optional<bool> running, canopen::TimePoint now) { timeout_.on_taken_over(running, now); }
  /// Boot-up, loss, leaving operational.
  void on_session_end();

  /// Ends what is due, and tells what to do. Values pass leases and waiting commands like a stop.
  [[nodiscard]] CommandTimeout::Action expire(canopen::TimePoint now);
  /// The outcome of `write_values`: each is to be answered by one of these.
  void on_values_confirmed() { timeout_.on_values_confirmed(); }
  void on_values_failed(std::string why, canopen::TimePoint now);
  [[nodiscard]] canopen::TimePoint next_time() const noexcept;

  /// The drive may run, and the command timeout acts where `writer` falls silent.
  [[nodiscard]] bool counts_on(const Writer& writer) const noexcept { return timeout_.counts_on(writer); }
  [[nodiscard]] ControlState state() const;

 private:
  [[nodiscard]] std::optional<alarms::ControlAlarm> alarm() const;

  Lease lease_;
  CommandTimeout timeout_;
  RunFeedback feedback_;
  canopen::Duration feedback_time_;
};

}  // namespace process
