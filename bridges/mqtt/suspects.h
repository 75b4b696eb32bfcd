#pragma once

#include <chrono>
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
/// changes; the second time whatever its payload; in any case for kHeldFor. Answers are never suspected: they are not
/// tried for long. Knows no time but what it is given. Not thread-safe.
class Suspects {
 public:
  using TimePoint = std::chrono::steady_clock::time_point;
  static constexpr std::chrono::minutes kHeldFor{10};
  /// A broker that ends the connection because of a message does so by then; a network that breaks is noticed later.
  static constexpr std::chrono::seconds kPrompt{5};

  struct Verdict {
    std::string topic;
    bool whatever = false;  ///< Its payload is.
    bool again = false;     ///< It was so before.
  };

  /// A connection broke with these under way, the last of which left at `left`. What is held back from now on.
  std::optional<Verdict> broke(const std::vector<const Message*>& under_way, TimePoint left, TimePoint now);
  /// Nothing else may be under way with it.
  [[nodiscard]] bool leaves_alone(const Message& message) const;
  [[nodiscard]] bool holds_back(const Message& message, TimePoint now) const;
  /// The broker acknowledged it.
  void arrived(const Message& message);

 private:
  struct Held {
    std::string payload;
    TimePoint until{};
    bool whatever = false;
  };

  std::set<std::string> suspected_;
  std::map<std::string, Held> held_;  ///< Until something of theirs is acknowledged.
};

}  // namespace mqtt
