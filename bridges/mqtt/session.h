#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "bridges/mqtt/broker.h"
#include "bridges/mqtt/topics.h"
#include "canopen/clock.h"

namespace mqtt {

/// What a new connection goes through before the gateway is `online`: subscribe to commands; after the gateway's start
/// also read back the alarms that the broker holds from before, so that none of them is overwritten unread; then
/// announce everything. Ends by itself: an answer or an alarm that does not come holds nothing up for long.
class Session {
 public:
  /// Longest wait for the answer to the subscription.
  static constexpr canopen::Duration kSubscribePatience = std::chrono::seconds(10);
  /// Longest wait for retained alarms after that answer. A topic that holds none says nothing, so the first start on a
  /// broker waits this long.
  static constexpr canopen::Duration kReadBack = std::chrono::seconds(1);

  enum class Phase : std::uint8_t { offline, subscribing, reading_back, ready };

  /// All outlive the session.
  Session(Broker& broker, const Topics& topics, std::size_t drives);

  void connected(ConnectionId connection, canopen::TimePoint now);
  void lost();
  void subscribed(canopen::TimePoint now);
  /// The emergency alarm of this drive came back.
  void alarm_came(std::size_t drive);
  /// Time passed.
  void tick(canopen::TimePoint now);

  /// Alarms that come are wanted.
  [[nodiscard]] bool reads_back() const noexcept;
  [[nodiscard]] Phase phase() const noexcept { return phase_; }
  [[nodiscard]] bool ready() const noexcept { return phase_ == Phase::ready; }
  [[nodiscard]] ConnectionId connection() const noexcept { return connection_; }
  /// When tick() has something to do; max(): never.
  [[nodiscard]] canopen::TimePoint deadline() const noexcept { return deadline_; }

 private:
  [[nodiscard]] bool all_known() const noexcept;
  [[nodiscard]] std::vector<std::string> alarm_topics() const;
  void finish();

  Broker& broker_;
  const Topics& topics_;
  ConnectionId connection_ = 0;
  Phase phase_ = Phase::offline;
  canopen::TimePoint deadline_ = canopen::TimePoint::max();
  std::vector<bool> alarm_known_;  ///< By drive: came back since the start.
  bool read_back_ = false;         ///< Once since the start.
};

}  // namespace mqtt
