#pragma once

#include <cstdint>

#include "canopen/clock.h"
#include "canopen/nmt.h"

namespace canopen {

/// What a heard NMT state means.
enum class StateMeaning : std::uint8_t {
  usual,        ///< As before, or as was commanded.
  from_before,  ///< From before the reset that we commanded: to be ignored.
  started,      ///< Operational, and not by a command of ours.
  left          ///< No longer operational, and not by a command of ours.
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
  /// The node is made pre-operational for its configuration, by a command that leaves at the latest at `until`: what it
  /// tells before it shows is from before.
  void give_for_configuration(TimePoint until) noexcept;
  /// What kept the node from being started does not count any more.
  void release() noexcept;

  /// The node tells its state; `unknown` means nothing.
  StateMeaning hear(NmtState state, TimePoint at) noexcept;

  /// What comes now may be from before the reset that we commanded.
  [[nodiscard]] bool from_before(TimePoint at) const noexcept { return wish_ == Wish::anew && at < settled_at_; }
  /// Neither stopped by command, nor has it left operational by itself.
  [[nodiscard]] bool may_start() const noexcept { return wish_ != Wish::held && wish_ != Wish::left; }
  [[nodiscard]] bool left_by_itself() const noexcept { return wish_ == Wish::left; }
  [[nodiscard]] bool held_by_command() const noexcept { return wish_ == Wish::held; }
  /// From then on a state that is not as commanded means something.
  [[nodiscard]] TimePoint settled_at() const noexcept { return settled_at_; }

  friend bool operator==(const NmtExpectation&, const NmtExpectation&) = default;

 private:
  enum class Wish : std::uint8_t {
    none,         ///< Nothing was commanded since it began.
    anew,         ///< It is about to begin anew, by a reset or for its configuration.
    operational,  ///< Started, by whomever.
    held,         ///< Stopped or made pre-operational by command.
    left          ///< It left operational by itself.
  };

  StateMeaning hear_operational(TimePoint at) noexcept;
  StateMeaning hear_other(TimePoint at) noexcept;

  Duration settling_;
  Wish wish_ = Wish::none;
  bool operational_ = false;  ///< The newest state heard.
  TimePoint settled_at_{};
};

}  // namespace canopen
