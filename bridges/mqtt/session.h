#pragma once

#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "bridges/mqtt/broker.h"
#include "bridges/mqtt/notice.h"
#include "bridges/mqtt/topics.h"
#include "canopen/clock.h"

namespace mqtt {

/// What a new connection goes through before the gateway is `online`: subscribe to commands, and to what others write
/// on topics of ours; then announce everything. An answer that does not come holds nothing up for long. A subscription
/// that is refused, or not answered, is tried again for as long as the connection stands.
class Session {
 public:
  /// Longest wait for the answer to a subscription.
  static constexpr canopen::Duration kSubscribePatience = std::chrono::seconds(10);
  /// Pauses before a subscription is tried again double from the one to the other.
  static constexpr canopen::Duration kFirstPause = std::chrono::seconds(1);
  static constexpr canopen::Duration kLongestPause = std::chrono::seconds(5);

  enum class Phase : std::uint8_t { offline, subscribing, ready };

  /// `broker` and `topics` outlive the session.
  Session(Broker& broker, const Topics& topics, Notice notice)
      : broker_(broker), topics_(topics), notice_(std::move(notice)) {}

  void connected(ConnectionId connection, canopen::TimePoint now);
  void lost();
  void subscribed(const Subscribed& answer, canopen::TimePoint now);
  /// Time passed.
  void tick(canopen::TimePoint now);

  [[nodiscard]] Phase phase() const noexcept { return phase_; }
  [[nodiscard]] bool ready() const noexcept { return phase_ == Phase::ready; }
  [[nodiscard]] ConnectionId connection() const noexcept { return connection_; }
  /// When tick() has something to do; max(): never.
  [[nodiscard]] canopen::TimePoint deadline() const noexcept;
  /// Filters whose subscription does not stand on this connection, as far as is known.
  [[nodiscard]] std::vector<std::string> refused() const;

 private:
  struct Entry {
    enum class State : std::uint8_t { asked, granted, refused };
    Subscription subscription;
    State state = State::asked;
    canopen::TimePoint at{};                ///< Asked: longest wait for the answer. Refused: when it is tried again.
    canopen::Duration pause = kFirstPause;  ///< The next one.
  };

  void refuse(Entry& entry, const std::string& why, canopen::TimePoint now);
  void finish();

  Broker& broker_;
  const Topics& topics_;
  Notice notice_;
  ConnectionId connection_ = 0;
  Phase phase_ = Phase::offline;
  std::vector<Entry> entries_;  ///< Of this connection.
  std::set<std::string> said_;  ///< Filters whose refusal is on the log, until they are granted.
};

}  // namespace mqtt
