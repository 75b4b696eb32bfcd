#pragma once

#include <boost/asio/awaitable.hpp>
#include <cstdint>
#include <string>
#include <vector>

#include "bridges/mqtt/message.h"

namespace mqtt {

/// Names one connection to the broker; every new one has a greater number.
using ConnectionId = std::uint64_t;

struct Subscription {
  std::string filter;
  int qos = 1;
  /// Topics that we publish on: what others write there from now on. With MQTT 3.1.1, which has no such choice, what is
  /// retained and our own messages come too.
  bool watched = false;
};

/// What a broker tells, on the loop, in the order in which it happened; and what it asks.
class BrokerEvents {
 public:
  virtual void on_connected(ConnectionId connection) = 0;
  virtual void on_disconnected() = 0;
  /// The answer to subscribe(): false when the broker refused any of it.
  virtual void on_subscribed(bool granted) = 0;
  virtual void on_message(Incoming message) = 0;
  /// From any thread, until stop(): the message is a command that stops a motor, to be lost last.
  [[nodiscard]] virtual bool is_stop(const Incoming& message) const = 0;

 protected:
  ~BrokerEvents() = default;
};

/// The way to a broker: the real one is Publisher, tests have one of their own. Used on the loop; nothing waits,
/// nothing throws. It reconnects by itself. Commands for a connection that is gone are ignored.
class Broker {
 public:
  virtual ~Broker() = default;

  /// `events` outlives the broker's stop().
  virtual void start(BrokerEvents& events) = 0;
  virtual void subscribe(ConnectionId connection, std::vector<Subscription> subscriptions) = 0;
  /// Keeps the messages until they can leave. While nothing can, the newest per topic.
  virtual void publish(std::vector<Message> batch) = 0;
  /// What was published may leave on this connection. Each new connection begins closed.
  virtual void open(ConnectionId connection) = 0;
  /// Publishes what is left and then `last`, disconnects and ends, all within a few seconds.
  virtual boost::asio::awaitable<void> stop(std::vector<Message> last) = 0;
};

}  // namespace mqtt
