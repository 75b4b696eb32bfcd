#pragma once

#include <boost/asio/awaitable.hpp>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "bridges/mqtt/message.h"

namespace mqtt {

/// Names one connection to the broker; every new one has a greater number.
using ConnectionId = std::uint64_t;

/// A connection that stands.
struct Connected {
  ConnectionId id = 0;
  int version = 5;       ///< 5, or 4 for MQTT 3.1.1.
  std::string broker{};  ///< `HOST:PORT` as configured.
  /// Of the several that its name may stand for, which may be brokers of their own; empty: the system took one.
  std::string address{};
};

/// Names the place that a connection leads to.
[[nodiscard]] inline std::string place_of(const Connected& connection) {
  return connection.address.empty() ? connection.broker : connection.broker + " " + connection.address;
}

/// What the broker said to one subscription.
struct Subscribed {
  std::string filter{};
  std::optional<std::string> refused{};  ///< Why not, in words.
};

/// What became of messages since the start.
struct BrokerCounts {
  std::uint64_t published = 0;         ///< The broker has them; with QoS 0: handed to the system.
  std::uint64_t messages_dropped = 0;  ///< Too long for the broker, refused by it, or no topic that can be sent to.
  std::uint64_t answers_dropped = 0;   ///< Too old, tried too often, or too many.
};

struct Subscription {
  std::string filter;
  int qos = 1;
  /// Topics that we publish on: what others write there from now on. With MQTT 3.1.1, which has no such choice, what is
  /// retained and our own messages come too.
  bool watched = false;
  /// Of a watched one: what is retained comes too, and is said to be.
  bool kept = false;
  /// Of a watched one: our own messages too, also with MQTT 5, for a will of our last connection counts as one of them.
  bool own_too = false;
  /// Much may come at once, and of each topic only the newest counts: it costs no command its place.
  bool bulk = false;
  /// Of a watched one, in words: what goes wrong where it is refused. Empty: what others write is not put right.
  std::string_view lost{};
};

/// What a broker tells, on the loop, in the order in which it happened; and what it asks.
class BrokerEvents {
 public:
  virtual void on_connected(const Connected& connection) = 0;
  /// on_disconnected() follows: another client connected with our client id.
  virtual void on_taken_over() {}
  /// None came about, for a reason that somebody has to mend: what, and how.
  virtual void on_no_connection(const std::string& /*why*/) {}
  /// The connection, to another broker than the first, is to be ended by leave() at the next good moment: the first one
  /// would take us. With `may` false it is not any more: the first one is gone again.
  virtual void on_may_leave(ConnectionId /*connection*/, bool /*may*/) {}
  /// `why` in words, with what the broker said by name.
  virtual void on_disconnected(const std::string& why) = 0;
  /// The answer to one of the subscriptions of subscribe(). None comes where the connection goes first.
  virtual void on_subscribed(const Subscribed& subscribed) = 0;
  /// It has ended. Not told where the connection goes first, or the broker refuses to.
  virtual void on_unsubscribed(const std::string& filter) = 0;
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
  /// Ends a subscription. What is on its way still comes, before on_unsubscribed().
  virtual void unsubscribe(ConnectionId connection, std::string filter) = 0;
  /// Keeps the messages until they can leave, of each retained topic the newest. What is retained is lost with the
  /// connection: the next one begins with everything.
  virtual void publish(std::vector<Message> batch) = 0;
  /// What was published may leave on this connection. Each new connection begins closed.
  virtual void open(ConnectionId connection) = 0;
  /// Ends the connection from this side: the will is published, for nobody is there until the next one, and the broker
  /// is told. on_disconnected(why) follows, and the next attempt after its pause.
  virtual void drop(ConnectionId connection, std::string why) = 0;
  /// Publishes what is left and then `last`, disconnects, and goes to the first broker. on_disconnected() follows.
  /// Answers that come meanwhile leave, here or there.
  virtual void leave(ConnectionId connection, std::vector<Message> last) = 0;
  /// Another client may have our client id: the attempt after this connection waits as after a take-over.
  virtual void suspect_takeover(ConnectionId connection) = 0;
  [[nodiscard]] virtual BrokerCounts counts() const = 0;
  /// False: the thread that serves the broker, or what it calls, stands still, or what could leave does not.
  [[nodiscard]] virtual bool alive() const = 0;
  /// Publishes what is left and then `last`, disconnects and ends, all within a few seconds.
  virtual boost::asio::awaitable<void> stop(std::vector<Message> last) = 0;
  /// After stop(): it may go without keeping anybody waiting.
  [[nodiscard]] virtual bool ended() const = 0;
};

}  // namespace mqtt
