#pragma once

#include <optional>
#include <string>
#include <vector>

#include "bridges/mqtt/message.h"
#include "bridges/process/health.h"
#include "canopen/clock.h"
#include "config/model.h"

namespace mqtt {

/// `B/health`: published when something of it changed but what is measured, at most once a second, and again before it
/// expires.
class HealthTopic {
 public:
  /// Shortest time between two messages; so often it is looked at, too.
  static constexpr canopen::Duration kPause = std::chrono::seconds(1);

  /// Both outlive it.
  HealthTopic(const std::string& topic, const config::Mqtt& settings) : topic_(topic), settings_(settings) {}

  /// A new connection: it is due whatever it says.
  void forget();
  /// Something of it may have changed. Returns when to come to collect().
  canopen::TimePoint mark(canopen::TimePoint now);
  [[nodiscard]] canopen::TimePoint next() const noexcept { return next_; }
  /// Appends it where it is due. Nothing before next().
  void collect(process::Health health, canopen::TimePoint now, std::vector<Message>& out);

 private:
  const std::string& topic_;
  const config::Mqtt& settings_;
  std::optional<process::Health> told_;  ///< On this connection.
  canopen::TimePoint told_at_{};
  canopen::TimePoint next_ = canopen::TimePoint::min();
};

}  // namespace mqtt
