#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

#include "bridges/mqtt/broker.h"
#include "bridges/mqtt/message.h"
#include "bridges/mqtt/tls_handshake.h"

namespace mqtt {

/// How one attempt to connect is made.
struct ClientSettings {
  std::string uri{};  ///< `tcp://192.0.2.1:1883`, numeric; `ssl://broker.example:8883`, as the certificate names it.
  int version = 5;    ///< 5, or 4 for MQTT 3.1.1.
  std::string client_id{};
  std::string username{};
  std::string password{};
  TlsFiles tls{};  ///< Of `ssl://`.
  std::string will_topic{};
  std::string will_payload{};
  int qos = 1;
  std::chrono::seconds keep_alive{10};
  std::chrono::seconds connect_timeout{5};
  /// MQTT 5: for as long a broker says nothing of a connection that broke, since the next one is there by then.
  std::chrono::seconds will_delay{5};
  /// MQTT 5: a session that ends earlier would let it speak at once (§3.1.2.5).
  std::chrono::seconds session_expiry{10};
};

/// What the broker takes.
struct BrokerLimits {
  std::size_t packet = 0;  ///< Longest packet in bytes (Maximum Packet Size of MQTT 5); 0: any.
  /// QoS 1 messages not yet acknowledged at a time, Receive Maximum of MQTT 5 at most. Few: what Paho holds when a
  /// connection goes cannot be overtaken by what is newer.
  std::size_t window = 16;
};

/// Why there is no connection.
struct Refusal {
  int code = -1;        ///< Of CONNACK; negative: none came.
  bool closed = false;  ///< The broker closed the connection without a CONNACK.
  bool nobody = false;  ///< Nobody takes connections there.
  std::string why{};    ///< Where somebody has to mend it: what, and how.
};

enum class Delivery : std::uint8_t {
  done,     ///< Acknowledged, or with QoS 0 written.
  refused,  ///< The broker took it and refused it.
  failed    ///< The connection went before.
};

/// What Paho tells, from its own threads, some of it while it holds its own lock: nothing here may call back into the
/// client, wait or throw.
class ClientEvents {
 public:
  virtual void on_up(BrokerLimits limits) noexcept = 0;
  virtual void on_refused(Refusal refusal) noexcept = 0;
  /// `code`: of the DISCONNECT that the broker sent; negative: none came.
  virtual void on_down(int code) noexcept = 0;
  virtual void on_incoming(Incoming&& message) noexcept = 0;
  /// `code`: of PUBACK.
  virtual void on_sent(const Message* message, Delivery delivery, int code) noexcept = 0;
  virtual void on_subscribed(Subscribed&& subscribed) noexcept = 0;
  virtual void on_unsubscribed(const std::string& filter) noexcept = 0;

 protected:
  ~ClientEvents() = default;
};

/// One attempt to connect and, where it succeeds, that connection: a Paho client of its own, without Paho's reconnect,
/// buffer or broker list, and with nothing on disk. Calls may block for moments; all are made by one thread, holding no
/// lock that the events take. Nothing throws. No event comes after the destructor: Paho calls under the lock that it
/// takes to destroy a client.
class Client {
 public:
  enum class Sent : std::uint8_t {
    yes,
    unfit,  ///< This message can never be sent.
    broken  ///< The connection is of no more use.
  };

  /// `events` outlives the client.
  Client(const ClientSettings& settings, ClientEvents& events);
  ~Client();
  Client(const Client&) = delete;
  Client& operator=(const Client&) = delete;

  /// False: it cannot even be tried, no event comes.
  [[nodiscard]] bool connect();
  /// on_sent() names the message by its address.
  [[nodiscard]] Sent publish(const Message& message);
  [[nodiscard]] bool subscribe(const Subscription& subscription);
  [[nodiscard]] bool unsubscribe(const std::string& filter);
  /// Says goodbye. `say_will`: publishes the will before, because after a goodbye the broker does not (Paho cannot ask
  /// for it, and never leaves without a goodbye).
  void disconnect(std::chrono::milliseconds patience, bool say_will);

 private:
  class Body;
  std::unique_ptr<Body> body_;
};

}  // namespace mqtt
