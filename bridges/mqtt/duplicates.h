#pragma once

#include <cstddef>
#include <deque>
#include <string>
#include <string_view>
#include <unordered_set>

#include "bridges/mqtt/message.h"
#include "canopen/clock.h"

namespace mqtt {

/// Remembers commands for 60 s. A command is the same as an earlier one when topic, payload, response topic and
/// correlation data are. One that carries neither an id nor correlation data is never taken for a repetition (stop,
/// start, stop would lose the second stop), unless the broker itself says that it may have come before.
class Duplicates {
 public:
  static constexpr canopen::Duration kMemory = std::chrono::seconds(60);
  /// Bytes of commands remembered; beyond, the oldest is forgotten early.
  static constexpr std::size_t kCapacity = 4UL * 1024 * 1024;

  /// True when it came before; else it is remembered.
  [[nodiscard]] bool seen(const Incoming& command, bool has_id, canopen::TimePoint now);

 private:
  struct Entry {
    canopen::TimePoint at;
    std::string_view key;  ///< Of keys_.
  };

  void forget_oldest();

  std::unordered_set<std::string> keys_;
  std::deque<Entry> entries_;
  std::size_t bytes_ = 0;
};

}  // namespace mqtt
