#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "bridges/alarms/control_alarm.h"
#include "bridges/process/control_use.h"
#include "bridges/process/writer.h"
#include "canopen/clock.h"
#include "config/model.h"

namespace process {

using config::OnTimeout;

/// The time without a sign of life that the writer of a running drive may take.
///
/// It counts from the last sign of life of the writer of the last confirmed `control_command`, as long as that is no
/// stop. Where a running drive was taken over nobody knows its writer: from the takeover, or the last sign of life of
/// any writer, while it runs. Signs of life are accepted commands and what else the ways count as such; they renew no
/// lease.
///
/// Where it has acted it acts no more, for any writer, and nothing of before is restored: only an accepted command that
/// writes `control_command` ends that. If the drive still holds a value that is no stop, the writer of that command is
/// watched from then on, whatever becomes of his command.
///
/// At the end of a session (boot-up, loss, left operational) nothing counts any more, and values that are not confirmed
/// are given up: a drive that comes back gets none of them.
class CommandTimeout {
 public:
  enum class Action : std::uint8_t { none, cease, write_values };

  /// `timeout` 0: never.
  CommandTimeout(canopen::Duration timeout, OnTimeout on_timeout) noexcept
      : timeout_(timeout), on_timeout_(on_timeout) {}

  void on_accepted(const Writer& writer, ControlUse use, canopen::TimePoint now);
  /// `use` of the value of `control_command` that was confirmed; also where the timeout's own values hold a stop.
  void on_confirmed(const Writer& writer, ControlUse use, canopen::TimePoint now);
  void on_sign_of_life(const Writer& writer, canopen::TimePoint now);
  /// `running`: nothing where it is not known yet.
  void on_taken_over(std::optional<bool> running, canopen::TimePoint now);
  void on_running(std::optional<bool> running);
  void on_session_end();

  /// What is to be done now. `write_values` again one second after it began, until confirmed; never while the last one
  /// is not answered by on_values_confirmed() or on_values_failed().
  [[nodiscard]] Action expire(canopen::TimePoint now);
  void on_values_confirmed();
  void on_values_failed(std::string why, canopen::TimePoint now);
  /// When expire() is to be called; kNever: not before something else happens.
  [[nodiscard]] canopen::TimePoint next_time() const noexcept;

  /// It will act where `writer` falls silent from now on.
  [[nodiscard]] bool counts_on(const Writer& writer) const noexcept {
    return counting_ && (!watched_ || *watched_ == writer);
  }
  /// It has acted, and no command has ended that.
  [[nodiscard]] bool acted() const noexcept { return acted_; }
  [[nodiscard]] std::optional<alarms::ControlAlarm> alarm() const;

 private:
  struct Sign {
    Writer writer;
    canopen::TimePoint at;
  };
  enum class Values : std::uint8_t { none, wanted, confirmed, given_up };

  void watch(std::optional<Writer> writer, canopen::TimePoint alive);
  [[nodiscard]] canopen::TimePoint due() const noexcept;
  [[nodiscard]] std::string text() const;

  canopen::Duration timeout_;
  OnTimeout on_timeout_;

  std::vector<Sign> signs_;  ///< Of those who gave a `control_command` that may still be confirmed.
  bool may_run_ = false;     ///< The last `control_command` that the drive is known to hold is no stop.
  bool counting_ = false;
  std::optional<Writer> watched_;  ///< Nobody: any writer.
  canopen::TimePoint alive_{};     ///< From when it counts.
  std::optional<canopen::TimePoint> second_look_;
  std::optional<canopen::TimePoint> taken_over_;  ///< And nobody knew whether it runs.

  bool acted_ = false;
  std::string silent_;  ///< Whose silence it was, for people.
  Values values_ = Values::none;
  std::string why_;  ///< The values are not confirmed.
  canopen::TimePoint try_at_ = canopen::kNever;
  canopen::TimePoint tried_at_{};
  std::uint32_t occasion_ = 0;              ///< A write under way may still be of an earlier one.
  std::optional<std::uint32_t> tried_for_;  ///< The occasion of the write under way.
};

}  // namespace process
