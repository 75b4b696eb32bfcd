#pragma once

#include <optional>
#include <string>
#include <vector>

#include "bridges/process/control_use.h"
#include "bridges/process/writer.h"
#include "canopen/clock.h"

namespace process {

/// Who keeps one drive to himself. An accepted command (one that passed all checks, whatever became of it) takes a free
/// lease, and renews the one of its writer. Nothing else does: a client that only reads keeps nobody away. So the
/// silence after which the lease ends is one of accepted commands.
///
/// A stop needs no lease. One of another than the holder leaves the lease as it is, but what was stopped is not to be
/// started again by a holder that has not noticed: each value of `control_command` that is no stop is refused to him
/// until he has written a stop himself, even where his lease ended in between. A client that writes "run" cyclically
/// would else undo the stop as soon as his own lease is over. A stop where nobody holds the lease takes it like any
/// other command.
class Lease {
 public:
  /// `length` 0: there are no leases, and nobody is ever refused.
  explicit Lease(canopen::Duration length) noexcept : length_(length) {}

  /// Why this command of `writer` is refused, for people: names the holder and the time left, or who stopped the drive.
  [[nodiscard]] std::optional<std::string> refuse(const Writer& writer, ControlUse use, canopen::TimePoint now) const;
  void on_accepted(const Writer& writer, ControlUse use, canopen::TimePoint now);
  /// Ends the lease where it is due.
  void expire(canopen::TimePoint now);
  /// When it ends unless renewed; kNever while nobody holds it.
  [[nodiscard]] canopen::TimePoint until() const noexcept { return until_; }

  [[nodiscard]] const std::optional<Writer>& holder() const noexcept { return holder_; }
  /// Since when the holder has it; zero while there is none.
  [[nodiscard]] canopen::WallTime since() const noexcept { return since_; }

 private:
  /// One that may write nothing but stops, and who stopped the drive.
  struct Blocked {
    Writer writer;
    Writer by;
  };

  [[nodiscard]] bool is_held_by_another(const Writer& writer, canopen::TimePoint now) const;
  void block_holder(const Writer& by);

  canopen::Duration length_;
  std::optional<Writer> holder_;
  canopen::WallTime since_{};
  canopen::TimePoint until_ = canopen::kNever;
  std::vector<Blocked> blocked_;  ///< Longest first.
};

}  // namespace process
