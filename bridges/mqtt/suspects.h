#pragma once

#include <chrono>
#include <cstddef>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "bridges/mqtt/message.h"

namespace mqtt {

/// Retained topics at which a broker may end the connection, each time: some do where a client may not write, or where
/// they cannot take what is written. What was under way when a connection broke for no other reason is suspected: on
/// the next one it leaves alone. The topic that was alone under way at a prompt break is held back, until its payload
/// changes; the second time whatever its payload. A network that breaks often may hit the same topic twice, and what is
/// held back may tell of a fault: so it is held back for kFirstHold, and each further time in a row for twice as long.
/// Until it is acknowledged it leaves behind all that a connection begins with, which it cannot keep from arriving.
/// Answers are never suspected: they are not tried for long. Knows no time but what it is given. Not thread-safe.
class Suspects {
 public:
  using TimePoint = std::chrono::steady_clock::time_point;
  static constexpr std::chrono::seconds kFirstHold{5};
  static constexpr std::chrono::seconds kLongestHold{600};
  static constexpr std::chrono::seconds kLongestHoldOfAlarms{60};  ///< And of statuses.
  /// A broker that ends the connection because of a message does so by then; a network that breaks is noticed later.
  static constexpr std::chrono::seconds kPrompt{5};

  struct Verdict {
    std::string topic;
    int times = 0;  ///< In a row; from the second on it is held back whatever its payload.
    std::chrono::seconds hold{};
  };

  /// A connection broke with these under way, the last of which left at `left`. What is held back from now on.
  std::optional<Verdict> broke(const std::vector<const Message*>& under_way, TimePoint left, TimePoint now);
  /// Nothing else may be under way with it.
  [[nodiscard]] bool leaves_alone(const Message& message) const;
  /// `begun`: this connection has said what each begins with.
  [[nodiscard]] bool holds_back(const Message& message, bool begun, TimePoint now) const;
  /// The broker acknowledged it.
  void acquit(const Message& message);
  /// A connection ended for another reason: nothing is suspected any more, but what is held back stays so.
  void forget() { suspected_.clear(); }

 private:
  struct Held {
    std::size_t size = 0;  ///< Of its payload; and its hash, for what is held back may be long.
    std::size_t hash = 0;
    TimePoint until{};
    int times = 0;
  };

  std::set<std::string> suspected_;
  std::map<std::string, Held> held_;  ///< Until something of theirs is acquitted.
};

}  // namespace mqtt
