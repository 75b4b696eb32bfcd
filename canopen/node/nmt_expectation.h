#pragma once

#include <cstdint>

#include "canopen/clock.h"
#include "canopen/nmt.h"

namespace canopen {

/// What a heard NMT state means.
enum class StateMeaning : std::uint8_t {
  usual,          ///< As before, or as was commanded.
  from_before,    ///< From before a command of ours that it follows by now: to be ignored.
  started,        ///< Operational, and not by a command of ours.
  started_again,  ///< Likewise, after it had left by itself.
  left            ///< No longer operational, and not by a command of ours.
};

/// Which NMT state a node should be in by what was commanded and heard, and what another one means. A plain value: who
/// gives a command that is not sent puts the one from before back.
class NmtExpectation {
 public:
  /// `settling`: the time after a command within which the state of before may still be told (heartbeat_timeout).
  explicit NmtExpectation(Duration settling) noexcept : settling_(settling) {}

  /// The node begins anew, by its boot-up message, or unseen where it was lost: any state is its own.
  void begin_anew() noexcept;
  /// A command of ours waits to leave, at the latest at `until`. A stop counts from here on: no boot may end in a start
  /// behind it, and the state that it brings is no wonder.
  void give(NmtCommand command, TimePoint until) noexcept;
  /// It has left, or may have.
  void leave(NmtCommand command, TimePoint now) noexcept;

  /// It is about to be configured, or a start of ours left it as it was: that it was started does not count any more.
  /// That it is not to be started does.
  void begin_boot() noexcept;
  /// It is made pre-operational for that, by a command that leaves at the latest at `until`.
  void interrupt_for_boot(TimePoint until) noexcept;
  /// Somebody asks us to start it, or it left only what he had begun: nothing keeps it from being started.
  void want_start() noexcept;

  /// The node tells its state; `unknown` means nothing.
  StateMeaning hear(NmtState state, TimePoint at) noexcept;

  /// What comes now may be from before a command of ours.
  [[nodiscard]] bool from_before(TimePoint at) const noexcept { return at < ignore_until_; }
  /// Neither stopped by command, nor has it left operational by itself.
  [[nodiscard]] bool may_start() const noexcept { return wish_ != Wish::held && !left_; }
  /// It left operational by itself and was not started since: it may have rebooted unseen.
  [[nodiscard]] bool left() const noexcept { return left_; }
  /// That is all that keeps it from being started: nobody has stopped it.
  [[nodiscard]] bool left_by_itself() const noexcept { return left_ && wish_ != Wish::held; }
  [[nodiscard]] bool held_by_command() const noexcept { return wish_ == Wish::held; }
  /// From then on a state that is not as commanded means something.
  [[nodiscard]] TimePoint settled_at() const noexcept { return settled_at_; }

  friend bool operator==(const NmtExpectation&, const NmtExpectation&) = default;

 private:
  enum class Wish : std::uint8_t {
    none,         ///< Nothing was commanded since it began.
    operational,  ///< Started, by whomever.
    held          ///< Stopped or made pre-operational by command.
  };

  StateMeaning hear_operational(TimePoint at) noexcept;
  StateMeaning hear_other(TimePoint at) noexcept;

  Duration settling_;
  Wish wish_ = Wish::none;
  bool left_ = false;
  bool operational_ = false;  ///< The newest state heard, or commanded.
  TimePoint settled_at_{};
  TimePoint ignore_until_{};  ///< `operational` told before then, and before any other state, is from before.
};

}  // namespace canopen
