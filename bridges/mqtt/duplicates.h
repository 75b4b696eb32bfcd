#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <unordered_map>

#include "bridges/mqtt/message.h"
#include "bridges/process/command.h"
#include "canopen/clock.h"

namespace mqtt {

/// Remembers commands for 60 s, and what became of them. A command is the same as an earlier one when topic, payload,
/// response topic and correlation data are. One that carries neither an id nor correlation data is never taken for a
/// repetition (start, reset, start would lose the second start), unless the broker itself says that it may have come
/// before.
class Duplicates {
 public:
  static constexpr canopen::Duration kMemory = std::chrono::seconds(60);
  /// Bytes of commands remembered; beyond, the oldest is forgotten early.
  static constexpr std::size_t kCapacity = 4UL * 1024 * 1024;

  /// Names one command that is remembered.
  using Ticket = std::uint64_t;
  static constexpr Ticket kNone = 0;  ///< Names none: nothing is remembered of it.

  struct Earlier {
    Ticket ticket = kNone;
    std::optional<std::string> first{};  ///< What became of it, as settle() was told; nothing: not known yet.
  };
  /// The command that this one repeats.
  [[nodiscard]] std::optional<Earlier> earlier(const Incoming& command, bool has_id, canopen::TimePoint now);

  /// From now on it is an earlier one, in place of one that is the same.
  [[nodiscard]] Ticket remember(const Incoming& command, canopen::TimePoint now);
  /// What became of it. Does nothing where it is forgotten already.
  void settle(Ticket ticket, std::string first);
  /// The same command again is a new one.
  void forget(Ticket ticket);

 private:
  struct Entry {
    Ticket ticket = kNone;
    canopen::TimePoint at;
    std::optional<std::string> first{};
  };
  using Entries = std::unordered_map<std::string, Entry>;

  void forget_old(canopen::TimePoint now);
  void limit();

  Entries entries_;                                ///< By what makes two commands the same.
  std::map<Ticket, Entries::value_type*> by_age_;  ///< Oldest first.
  Ticket last_ = kNone;
  std::size_t bytes_ = 0;
};

/// It was refused before anything was sent, for a reason that may be gone or that the sender may put right: the same
/// command again is a new one.
[[nodiscard]] bool may_come_again(const process::Outcome& outcome) noexcept;

}  // namespace mqtt
