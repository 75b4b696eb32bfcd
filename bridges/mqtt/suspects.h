#pragma once

#include <chrono>
#include <list>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "bridges/mqtt/message.h"
#include "bridges/mqtt/outbox.h"

namespace mqtt {

/// Retained topics at which a broker may end the connection, each time: some do where a client may not write, or where
/// they cannot take what is written. What was under way when a connection broke for no other reason is suspected: on
/// the next one it leaves alone. The topic that was alone under way at a prompt break is held back, until its payload
/// changes; the second time whatever its payload; in any case for kHeldFor. Answers are never suspected: they are not
/// tried for long. Knows no time but what it is given. Not thread-safe.
class Suspects {
 public:
  using TimePoint = Outbox::TimePoint;
  static constexpr std::chrono::minutes kHeldFor{10};
  /// A broker that ends the connection because of a message does so by then; a network that breaks is noticed later.
  static constexpr std::chrono::seconds kPrompt{5};

  struct Held {
    std::string topic;
    bool whatever = false;  ///< Its payload is.
  };

  /// A connection broke with these under way, the last of which left at `left`. What is to be told of it: the first and
  /// the second time that a topic is held back.
  std::optional<Held> broke(const std::list<Outbox::Item>& under_way, TimePoint left, TimePoint now);
  /// Nothing else may be under way with it.
  [[nodiscard]] bool leaves_alone(const Message& message, TimePoint now) const;
  [[nodiscard]] bool holds_back(const Message& message, TimePoint now) const;
  /// Keeps one that is held back until then.
  void keep(Message message);
  /// These are newer than what was kept.
  void forget_kept(const std::vector<Message>& newer);
  /// Those kept for long enough.
  [[nodiscard]] std::vector<Message> release(TimePoint now);
  /// The next connection begins with everything.
  void forget_kept();
  /// The broker acknowledged it.
  void arrived(const Message& message);

 private:
  struct Conviction {
    std::string payload;
    TimePoint until{};
    bool whatever = false;
    std::optional<Message> kept{};
  };

  std::set<std::string> suspected_;
  std::map<std::string, Conviction> convicted_;  ///< Until something of theirs is acknowledged.
};

}  // namespace mqtt
