#include "bridges/mqtt/client.h"

#include <mqtt/async_client.h>

#include <algorithm>
#include <exception>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include "bridges/mqtt/paho_options.h"
#include "bridges/mqtt/reasons.h"
#include "bridges/mqtt/shelf.h"
#include "canopen/clock.h"

namespace mqtt {
namespace {

// Of a SUBACK that says nothing.
constexpr int kUnspecified = 0x80;

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

// The broker was there and closed the connection instead of a CONNACK. Paho has no code for that, only a text, which it
// has too where a host far away refuses the connection.
bool was_closed(const token& failed) {
  try {
    // It is over: this does not wait, it throws.
    (void)const_cast<token&>(failed).try_wait();  // NOLINT(cppcoreguidelines-pro-type-const-cast)
  } catch (const exception& failure) {
    return failure.get_message() == "TCP connect completion failure";
  }
  return false;
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

class Listener final : public iaction_listener {
 public:
  using Call = std::function<void(const token&)>;
  Listener(Call succeeded, Call failed) : succeeded_(std::move(succeeded)), failed_(std::move(failed)) {}
  void on_success(const token& done) override { succeeded_(done); }
  void on_failure(const token& done) override { failed_(done); }

 private:
  Call succeeded_;
  Call failed_;
};

}  // namespace

class Client::Body final : private callback {
 public:
  Body(const ClientSettings& settings, ClientEvents& events)
      : events_(events),
        settings_(settings),
        client_(settings_.uri, settings_.client_id, creation_of(settings_), &shelf_) {
    client_.set_callback(*this);  // which Paho does not tell of a DISCONNECT
    client_.set_disconnected_handler(
        [this](const properties&, ReasonCode code) { events_.on_down(static_cast<int>(code)); });
  }

  // Properties are only made while a client exists: Paho forgets, and so leaks, what it allocated before its first one.
  void connect() { client_.connect(options_of(settings_), nullptr, connecting_); }

  void publish(const Message& message) {
    properties given;
    if (settings_.version >= MQTTVERSION_5) {
      if (message.correlation) {
        given.add({property::CORRELATION_DATA, *message.correlation});
      }
      if (message.expiry != 0) {
        given.add({property::MESSAGE_EXPIRY_INTERVAL, static_cast<std::int32_t>(message.expiry)});
      }
    }
    // Paho hands back what it was given.
    void* const name = const_cast<Message*>(&message);  // NOLINT(cppcoreguidelines-pro-type-const-cast)
    client_.publish(mqtt::message::create(message.topic, message.payload, settings_.qos, message.retained, given), name,
                    publishing_);
  }

  // One by one: Paho C++ 1.2.0 crashes when it passes several MQTT 5 options in one request.
  void subscribe(const Subscription& subscription) {
    client_.subscribe(subscription.filter, subscription.qos, nullptr, subscribing_,
                      settings_.version >= MQTTVERSION_5 ? options_of(subscription) : subscribe_options());
  }

  void unsubscribe(const std::string& filter) { client_.unsubscribe(filter, nullptr, unsubscribing_); }

  void disconnect(std::chrono::milliseconds patience, bool say_will) {
    if (say_will) {
      // QoS 0 waits for no acknowledgement of others. Where not even this leaves, neither does the goodbye, and the
      // broker publishes the will itself.
      client_.publish(message::create(settings_.will_topic, settings_.will_payload, 0, true));
    }
    client_.disconnect(patience)->wait_for(patience * 2);
  }

 private:
  void connection_lost(const string&) override { events_.on_down(-1); }
  void message_arrived(const_message_ptr received) override {
    try {
      events_.on_incoming(incoming_of(*received));
    } catch (const std::exception&) {
      events_.on_down(-1);  // no memory: begin again rather than lose a command unseen
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
    int code = kUnspecified;
    try {
      const subscribe_response response = done.get_subscribe_response();
      const std::vector<ReasonCode>& codes = response.get_reason_codes();
      code = codes.empty() ? kUnspecified : static_cast<int>(codes.front());
    } catch (const std::exception&) {
      code = kUnspecified;
    }
    was_answered(done, code);
  }

  static std::string filter_of(const token& done) {
    const auto topics = done.get_topics();
    return topics && !topics->empty() ? (*topics)[0] : std::string();
  }

  void was_answered(const token& done, int code) {
    Subscribed subscribed{.filter = filter_of(done)};
    if (is_failure(code)) {
      subscribed.refused = reason_text(code);
    }
    events_.on_subscribed(std::move(subscribed));
  }

  void was_not_granted(const token& done) {
    // The connection went before the answer: with MQTT 3.1.1 Paho says so before it tells of the loss.
    if (done.get_return_code() != MQTTASYNC_OPERATION_INCOMPLETE) {
      const int code = static_cast<int>(done.get_reason_code());
      was_answered(done, is_failure(code) ? code : kUnspecified);
    }
  }

  void was_sent(const token& done, bool acknowledged) {
    const int code = static_cast<int>(done.get_reason_code());
    const Delivery otherwise = is_failure(code) ? Delivery::refused : Delivery::failed;
    events_.on_sent(static_cast<const Message*>(done.get_user_context()), acknowledged ? Delivery::done : otherwise,
                    code);
  }

  void was_refused(const token& done) {
    events_.on_refused({.code = done.get_return_code(), .closed = was_closed(done)});
  }

  ClientEvents& events_;
  ClientSettings settings_;
  Listener connecting_{[this](const token& done) { came_up(done); }, [this](const token& done) { was_refused(done); }};
  Listener publishing_{[this](const token& done) { was_sent(done, true); },
                       [this](const token& done) { was_sent(done, false); }};
  Listener subscribing_{[this](const token& done) { was_granted(done); },
                        [this](const token& done) { was_not_granted(done); }};
  Listener unsubscribing_{[this](const token& done) { events_.on_unsubscribed(filter_of(done)); },
                          [](const token&) {}};  // whoever waits for it gives up
  Shelf shelf_;
  async_client client_;  ///< The last member: gone before what it calls.
};

namespace {

template <class Call>
bool succeeds(Call call) {
  try {
    call();
    return true;
  } catch (const std::exception&) {
    return false;
  }
}

}  // namespace

Client::Client(const ClientSettings& settings, ClientEvents& events) {
  // Paho writes each of its steps down for a trace that nobody reads: a sixth of the time that it takes for a message.
  MQTTAsync_setTraceLevel(MQTTASYNC_TRACE_ERROR);
  if (!succeeds([&] { body_ = std::make_unique<Body>(settings, events); })) {
    body_ = nullptr;  // connect() tells
  }
}

Client::~Client() = default;

bool Client::connect() {
  return body_ && succeeds([this] { body_->connect(); });
}

Client::Sent Client::publish(const Message& message) {
  try {
    body_->publish(message);
    return Sent::yes;
  } catch (const exception& failure) {
    return failure.get_return_code() == MQTTASYNC_BAD_UTF8_STRING ? Sent::unfit : Sent::broken;
  } catch (const std::exception&) {
    return Sent::broken;
  }
}

bool Client::subscribe(const Subscription& subscription) {
  return succeeds([&] { body_->subscribe(subscription); });
}

bool Client::unsubscribe(const std::string& filter) {
  return succeeds([&] { body_->unsubscribe(filter); });
}

void Client::disconnect(std::chrono::milliseconds patience, bool say_will) {
  (void)succeeds([&] { body_->disconnect(patience, say_will); });  // else it is gone already
}

}  // namespace mqtt
