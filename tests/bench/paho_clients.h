#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

// Plain Paho clients. Paho's own namespace is called like our room's, so its headers stay in paho_clients.cpp.

namespace bench {

struct Published {
  std::string topic;
  std::string payload;
};

/// Counts what arrives at a subscription, and keeps the first of it.
class Subscriber {
 public:
  /// Told of each payload, in Paho's thread.
  using Handler = std::function<void(const std::string& payload)>;

  /// Waits a few seconds for the broker at `uri`; throws std::runtime_error when it does not answer.
  Subscriber(const std::string& uri, const std::string& filter, Handler handler = {});
  ~Subscriber();
  Subscriber(const Subscriber&) = delete;
  Subscriber& operator=(const Subscriber&) = delete;

  /// Throws std::runtime_error when nothing arrives for some seconds.
  void wait_for_first() const;
  [[nodiscard]] std::vector<Published> kept() const;
  /// Messages per second over a while, after a moment to get going.
  [[nodiscard]] double rate() const;

  static constexpr std::size_t kKept = 2000;

 private:
  class Body;
  std::unique_ptr<Body> body_;
};

/// Messages per second at a subscriber, while Paho publishes `messages` again and again as fast as it takes them.
[[nodiscard]] double bare_rate(const std::string& uri, const std::vector<Published>& messages);

}  // namespace bench
