#pragma once

#include <chrono>
#include <memory>
#include <optional>
#include <semaphore>
#include <string>
#include <vector>

#include "bridges/mqtt/connection.h"
#include "bridges/mqtt/loop_post.h"
#include "bridges/mqtt/resolve.h"
#include "bridges/mqtt/traffic.h"
#include "config/model.h"

namespace mqtt {

/// How the publisher behaves; the defaults are for real plants.
struct PublisherSettings {
  config::Endpoint broker;
  ConnectionSettings connection;  ///< Its uri and version are filled in per attempt.
  std::size_t outbox = 8192;      ///< Messages of each kind.
  std::chrono::milliseconds first_pause{1000};
  std::chrono::milliseconds longest_pause{30000};
  std::chrono::milliseconds farewell{2000};  ///< For the last messages at the end.
  Resolver resolver = resolve;
};

/// The publisher's thread: connects, sends what the loop gave it, connects again. It alone calls Paho.
class Worker {
 public:
  Worker(PublisherSettings settings, std::shared_ptr<LoopPost> loop);

  /// What the loop gives.
  [[nodiscard]] Traffic& traffic() noexcept { return traffic_; }
  [[nodiscard]] const PublisherSettings& settings() const noexcept { return settings_; }

  /// The thread's work; posts Ended and returns after Traffic::finish().
  void run();
  /// True when run() returned within `limit`. Waits; once.
  [[nodiscard]] bool await_end(std::chrono::milliseconds limit) { return ended_.try_acquire_for(limit); }

 private:
  /// One attempt and what follows; returns why it ended.
  std::string attempt();
  std::string next_address();
  /// Nothing when it stands; else the broker's code, negative where there is none.
  std::optional<int> connect(const std::string& address, int version);
  /// Sends until the connection is gone or everything was said; returns why it ended.
  std::string serve();
  bool send(Traffic::Work& work);
  void drop_connection();
  void say(Level level, std::string text);
  void say_failure(const std::string& why);

  const PublisherSettings settings_;
  const std::shared_ptr<LoopPost> loop_;
  Traffic traffic_;
  std::unique_ptr<Connection> connection_;
  ConnectionId current_ = 0;
  std::vector<std::string> addresses_;
  std::size_t next_address_ = 0;
  std::string last_failure_;
  std::binary_semaphore ended_{0};
};

}  // namespace mqtt
