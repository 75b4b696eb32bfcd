#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bridges/mqtt/broker.h"
#include "bridges/mqtt/message.h"

namespace mqtt {

/// How one attempt to connect is made.
struct ConnectionSettings {
  std::string uri;  ///< `tcp://192.0.2.1:1883`, numeric.
  int version = 5;  ///< 5, or 4 for MQTT 3.1.1.
  std::string client_id;
  std::string username;
  std::string password;
  std::string will_topic;
  std::string will_payload;
  int qos = 1;
  std::chrono::seconds keep_alive{10};
  std::chrono::seconds connect_timeout{5};
};

/// A message that is on its way; its address names it.
struct InFlight {
  std::optional<Message> answer;  ///< Sent again when the connection breaks first.
};

/// What the broker takes.
struct BrokerLimits {
  std::size_t packet = 0;  ///< Longest message in bytes; 0: any.
  /// QoS 1 messages not yet acknowledged at a time (Receive Maximum of MQTT 5). Paho takes more, but then sends some
  /// hundred times slower; so ours wait in the outbox.
  std::size_t window = 100;
};

enum class Delivery : std::uint8_t {
  done,     ///< Acknowledged, or with QoS 0 written.
  refused,  ///< The broker took it and refused it.
  failed    ///< The connection went before.
};

/// What Paho tells, from its own threads, some of it while it holds its own lock: nothing here may call back into the
/// connection, wait or throw.
class ConnectionEvents {
 public:
  virtual void on_up(BrokerLimits limits) noexcept = 0;
  /// Connecting failed; `code` is that of CONNACK, or negative where none came.
  virtual void on_refused(int code) noexcept = 0;
  virtual void on_down() noexcept = 0;
  virtual void on_incoming(Incoming&& message) noexcept = 0;
  virtual void on_sent(const InFlight* message, Delivery delivery) noexcept = 0;
  virtual void on_subscribed(Subscribed&& subscribed) noexcept = 0;

 protected:
  ~ConnectionEvents() = default;
};

/// One attempt to connect and, where it succeeds, that connection: a Paho client of its own, without Paho's reconnect,
/// buffer, broker list or persistence. Calls may block for moments; all are made by one thread, holding no lock that
/// the events take. Nothing throws.
class Connection {
 public:
  enum class Sent : std::uint8_t {
    yes,
    unfit,  ///< This message can never be sent.
    broken  ///< The connection is of no more use.
  };

  /// `events` outlives the connection.
  Connection(const ConnectionSettings& settings, ConnectionEvents& events);
  ~Connection();
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  /// False: it cannot even be tried, no event comes.
  [[nodiscard]] bool connect();
  /// Fills `in_flight`, which stays in its place until on_sent() names it or the connection is gone.
  [[nodiscard]] Sent publish(Message message, InFlight& in_flight);
  [[nodiscard]] bool subscribe(const std::vector<Subscription>& subscriptions);
  [[nodiscard]] bool unsubscribe(const std::string& filter);
  /// Says goodbye. `say_will`: publishes the will before, because after a goodbye the broker does not (Paho cannot ask
  /// for it, and never leaves without a goodbye).
  void disconnect(std::chrono::milliseconds patience, bool say_will);

 private:
  class Body;
  std::unique_ptr<Body> body_;
};

}  // namespace mqtt
