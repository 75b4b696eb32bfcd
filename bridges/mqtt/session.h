#pragma once

#include <cstddef>
#include <cstdint>

#include "bridges/mqtt/broker.h"
#include "bridges/mqtt/topics.h"
#include "canopen/clock.h"

namespace mqtt {

/// What a new connection goes through before the gateway is `online`: subscribe to commands, and to what others write
/// on topics of ours; then announce everything. Ends by itself: an answer that does not come holds nothing up for long.
class Session {
 public:
  /// Longest wait for the answer to the subscription.
  static constexpr canopen::Duration kSubscribePatience = std::chrono::seconds(10);

  enum class Phase : std::uint8_t { offline, subscribing, ready };

  /// Both outlive the session.
  Session(Broker& broker, const Topics& topics) : broker_(broker), topics_(topics) {}

  void connected(ConnectionId connection, canopen::TimePoint now);
  void lost();
  /// One of the subscriptions was answered.
  void subscribed();
  /// Time passed.
  void tick(canopen::TimePoint now);

  [[nodiscard]] Phase phase() const noexcept { return phase_; }
  [[nodiscard]] bool ready() const noexcept { return phase_ == Phase::ready; }
  [[nodiscard]] ConnectionId connection() const noexcept { return connection_; }
  /// When tick() has something to do; max(): never.
  [[nodiscard]] canopen::TimePoint deadline() const noexcept { return deadline_; }

 private:
  void finish();

  Broker& broker_;
  const Topics& topics_;
  ConnectionId connection_ = 0;
  std::size_t awaited_ = 0;  ///< Answers to subscriptions.
  Phase phase_ = Phase::offline;
  canopen::TimePoint deadline_ = canopen::TimePoint::max();
};

}  // namespace mqtt
