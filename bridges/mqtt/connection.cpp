#include "bridges/mqtt/connection.h"

#include <mqtt/async_client.h>

#include <algorithm>
#include <exception>
#include <memory>
#include <utility>

#include "canopen/clock.h"

namespace mqtt {
namespace {

constexpr int kWindow = static_cast<int>(BrokerLimits{}.window);
// Of ours that Paho may hold; our window stays below it, so it never refuses one.
constexpr int kPahoBuffer = kWindow * 2;
// Longest message we take, in bytes (MQTT 5 only): the broker drops longer ones.
constexpr std::int32_t kMaxIncoming = 128 * 1024;
// Reason codes from here on are failures (MQTT 5 §2.4); so is 0x80 in a SUBACK of 3.1.1 (§3.9.3).
constexpr int kFirstFailure = 0x80;

connect_options options_of(const ConnectionSettings& settings) {
  connect_options options;
  options.set_mqtt_version(settings.version);
  if (settings.version >= MQTTVERSION_5) {
    options.set_clean_start(true);
    options.set_properties({{property::SESSION_EXPIRY_INTERVAL, 0}, {property::MAXIMUM_PACKET_SIZE, kMaxIncoming}});
  } else {
    options.set_clean_session(true);
  }
  options.set_automatic_reconnect(false);
  options.set_keep_alive_interval(settings.keep_alive);
  options.set_connect_timeout(settings.connect_timeout);
  options.set_max_inflight(kWindow);
  if (!settings.username.empty()) {
    options.set_user_name(settings.username);
    options.set_password(settings.password);
  }
  options.set_will(will_options(settings.will_topic, settings.will_payload, settings.qos, true));
  return options;
}

subscribe_options options_of(const Subscription& subscription) {
  if (subscription.watched) {
    return subscribe_options(subscribe_options::SUBSCRIBE_NO_LOCAL, subscribe_options::NO_RETAIN_AS_PUBLISHED,
                             subscribe_options::DONT_SEND_RETAINED);
  }
  return subscribe_options(subscribe_options::SUBSCRIBE_LOCAL, subscribe_options::RETAIN_AS_PUBLISHED);
}

create_options creation_of(const ConnectionSettings& settings) {
  create_options options(settings.version, kPahoBuffer);
  options.set_send_while_disconnected(false);
  options.set_restore_messages(false);
  options.set_persist_qos0(false);
  return options;
}

BrokerLimits limits_of(const token& connected) {
  BrokerLimits limits;
  const connect_response response = connected.get_connect_response();
  const properties& given = response.get_properties();
  if (given.contains(property::MAXIMUM_PACKET_SIZE)) {
    limits.packet = get<std::uint32_t>(given, property::MAXIMUM_PACKET_SIZE);
  }
  if (given.contains(property::RECEIVE_MAXIMUM)) {
    limits.window = std::clamp<std::size_t>(get<std::uint16_t>(given, property::RECEIVE_MAXIMUM), 1, limits.window);
  }
  return limits;
}

Incoming incoming_of(const message& received) {
  Incoming incoming{.topic = received.get_topic(),
                    .payload = received.get_payload_str(),
                    .retained = received.is_retained(),
                    .redelivered = received.is_duplicate(),
                    .received = canopen::Clock::now()};
  const properties& given = received.get_properties();
  if (given.contains(property::RESPONSE_TOPIC)) {
    incoming.response_topic = get<string>(given, property::RESPONSE_TOPIC);
  }
  if (given.contains(property::CORRELATION_DATA)) {
    incoming.correlation = get<string>(given, property::CORRELATION_DATA);
  }
  if (given.contains(property::MESSAGE_EXPIRY_INTERVAL)) {
    incoming.expiry = get<std::uint32_t>(given, property::MESSAGE_EXPIRY_INTERVAL);
  }
  return incoming;
}

}  // namespace

class Connection::Body final : private callback {
 public:
  Body(const ConnectionSettings& settings, ConnectionEvents& events)
      : events_(events),
        settings_(settings),
        client_(settings_.uri, settings_.client_id, creation_of(settings_), nullptr) {
    client_.set_callback(*this);
  }

  // Properties are only made while a client exists: Paho forgets, and so leaks, what it allocated before its first one.
  void connect() { client_.connect(options_of(settings_), nullptr, connecting_); }

  void publish(Message message, InFlight& in_flight) {
    properties given;
    if (settings_.version >= MQTTVERSION_5 && message.correlation) {
      given.add({property::CORRELATION_DATA, *message.correlation});
    }
    if (message.kind == MessageKind::answer) {
      in_flight.answer = message;
    }
    client_.publish(
        message::create(std::move(message.topic), std::move(message.payload), settings_.qos, message.retained, given),
        &in_flight, publishing_);
  }

  // One by one: Paho C++ 1.2.0 crashes when it passes several MQTT 5 options in one request.
  void subscribe(const std::vector<Subscription>& subscriptions) {
    for (const Subscription& subscription : subscriptions) {
      client_.subscribe(subscription.filter, subscription.qos, nullptr, subscribing_,
                        settings_.version >= MQTTVERSION_5 ? options_of(subscription) : subscribe_options());
    }
  }

  void unsubscribe(const std::string& filter) { client_.unsubscribe(filter); }

  void disconnect(std::chrono::milliseconds patience, bool say_will) {
    if (say_will) {
      // QoS 0 waits for no acknowledgement of others. Where not even this leaves, neither does the goodbye, and the
      // broker publishes the will itself.
      client_.publish(message::create(settings_.will_topic, settings_.will_payload, 0, true));
    }
    client_.disconnect(patience)->wait_for(patience * 2);
  }

 private:
  void connection_lost(const string&) override { events_.on_down(); }
  void message_arrived(const_message_ptr received) override {
    try {
      events_.on_incoming(incoming_of(*received));
    } catch (const std::exception&) {
      events_.on_down();  // no memory: begin again rather than lose a command unseen
    }
  }

  void came_up(const token& done) {
    BrokerLimits limits;
    try {
      limits = limits_of(done);
    } catch (const std::exception&) {
      limits = {};  // 3.1.1 says nothing of the kind
    }
    events_.on_up(limits);
  }

  void was_granted(const token& done) {
    try {
      const subscribe_response response = done.get_subscribe_response();
      const auto codes = response.get_reason_codes();
      was_answered(done, codes.empty() ? 0 : static_cast<int>(codes.front()));
    } catch (const std::exception&) {
      was_answered(done, kFirstFailure);
    }
  }

  void was_answered(const token& done, int code) {
    const auto topics = done.get_topics();
    Subscribed subscribed{.filter = topics && !topics->empty() ? (*topics)[0] : std::string()};
    if (code >= kFirstFailure) {
      subscribed.refused = "refused with code " + std::to_string(code);
    }
    events_.on_subscribed(std::move(subscribed));
  }

  void was_sent(const token& done, Delivery delivery) {
    events_.on_sent(static_cast<const InFlight*>(done.get_user_context()), delivery);
  }

  ConnectionEvents& events_;
  ConnectionSettings settings_;
  struct Connecting final : iaction_listener {
    explicit Connecting(Body& to_body) : body(to_body) {}
    void on_success(const token& done) override { body.came_up(done); }
    void on_failure(const token& done) override { body.events_.on_refused(done.get_return_code()); }
    Body& body;
  } connecting_{*this};
  struct Publishing final : iaction_listener {
    explicit Publishing(Body& to_body) : body(to_body) {}
    void on_success(const token& done) override { body.was_sent(done, Delivery::done); }
    void on_failure(const token& done) override {
      const bool refused = static_cast<int>(done.get_reason_code()) >= kFirstFailure;
      body.was_sent(done, refused ? Delivery::refused : Delivery::failed);
    }
    Body& body;
  } publishing_{*this};
  struct Subscribing final : iaction_listener {
    explicit Subscribing(Body& to_body) : body(to_body) {}
    void on_success(const token& done) override { body.was_granted(done); }
    void on_failure(const token& done) override { body.was_answered(done, kFirstFailure); }
    Body& body;
  } subscribing_{*this};
  async_client client_;  ///< The last member: gone before what it calls.
};

Connection::Connection(const ConnectionSettings& settings, ConnectionEvents& events) {
  try {
    body_ = std::make_unique<Body>(settings, events);
  } catch (const std::exception&) {
    body_ = nullptr;  // connect() tells
  }
}

Connection::~Connection() = default;

bool Connection::connect() {
  if (!body_) {
    return false;
  }
  try {
    body_->connect();
    return true;
  } catch (const std::exception&) {
    return false;
  }
}

Connection::Sent Connection::publish(Message message, InFlight& in_flight) {
  try {
    body_->publish(std::move(message), in_flight);
    return Sent::yes;
  } catch (const exception& failure) {
    return failure.get_return_code() == MQTTASYNC_BAD_UTF8_STRING ? Sent::unfit : Sent::broken;
  } catch (const std::exception&) {
    return Sent::broken;
  }
}

bool Connection::subscribe(const std::vector<Subscription>& subscriptions) {
  try {
    body_->subscribe(subscriptions);
    return true;
  } catch (const std::exception&) {
    return false;
  }
}

bool Connection::unsubscribe(const std::string& filter) {
  try {
    body_->unsubscribe(filter);
    return true;
  } catch (const std::exception&) {
    return false;
  }
}

void Connection::disconnect(std::chrono::milliseconds patience, bool say_will) {
  try {
    body_->disconnect(patience, say_will);
  } catch (const std::exception&) {
    return;  // it is gone already
  }
}

}  // namespace mqtt
