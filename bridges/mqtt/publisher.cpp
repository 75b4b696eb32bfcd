#include "bridges/mqtt/publisher.h"

#include <boost/asio/redirect_error.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <boost/system/error_code.hpp>
#include <utility>

#include "bridges/mqtt/topics.h"

namespace mqtt {

Publisher::Publisher(boost::asio::any_io_executor executor, PublisherSettings settings, Notice notice)
    : notice_(std::move(notice)),
      loop_(std::make_shared<LoopPost>(executor, [this](LoopEvent& event) { receive(event); })),
      broker_thread_(std::make_shared<BrokerThread>(std::move(settings), loop_)),
      ended_timer_(executor) {}

Publisher::~Publisher() {
  loop_->close();
  if (thread_.joinable()) {  // not stopped in order: the broker publishes the will
    broker_thread_->finish({}, std::chrono::milliseconds(0));
    ended_ = broker_thread_->await_end(std::chrono::milliseconds(2000));
    leave();
  }
}

void Publisher::start(BrokerEvents& events) {
  events_ = &events;
  loop_->tell_stops_by([&events](const Incoming& message) { return events.is_stop(message); });
  thread_ = std::thread([shared = broker_thread_] { shared->run(); });
}

void Publisher::subscribe(ConnectionId connection, std::vector<Subscription> subscriptions) {
  broker_thread_->subscribe(connection, std::move(subscriptions));
}

void Publisher::unsubscribe(ConnectionId connection, std::vector<std::string> filters) {
  broker_thread_->unsubscribe(connection, std::move(filters));
}

void Publisher::publish(std::vector<Message> batch) {
  broker_thread_->publish(std::move(batch));
}

BrokerCounts Publisher::counts() const {
  return broker_thread_->counts();
}

bool Publisher::alive() const {
  return broker_thread_->alive();
}

void Publisher::open(ConnectionId connection) {
  broker_thread_->open(connection);
}

void Publisher::drop(ConnectionId connection, std::string why) {
  broker_thread_->drop(connection, std::move(why));
}

void Publisher::suspect_takeover(ConnectionId connection) {
  broker_thread_->suspect_takeover(connection);
}

boost::asio::awaitable<void> Publisher::stop(std::vector<Message> last) {
  if (thread_.joinable()) {
    broker_thread_->finish(std::move(last), broker_thread_->settings().farewell);
    ended_timer_.expires_after(kStopLimit);
    boost::system::error_code ignored;
    if (!ended_) {
      co_await ended_timer_.async_wait(boost::asio::redirect_error(boost::asio::use_awaitable, ignored));
    }
    leave();
  }
  loop_->close();
}

void Publisher::receive(LoopEvent& event) {
  if (auto* message = std::get_if<Incoming>(&event)) {
    events_->on_message(std::move(*message));
  } else if (const auto* connected = std::get_if<Connected>(&event)) {
    events_->on_connected(*connected);
  } else if (const auto* gone = std::get_if<Disconnected>(&event)) {
    if (gone->taken_over) {
      events_->on_taken_over();
    }
    events_->on_disconnected(gone->why);
  } else if (const auto* subscribed = std::get_if<Subscribed>(&event)) {
    events_->on_subscribed(*subscribed);
  } else if (auto* said = std::get_if<Said>(&event)) {
    notice_(said->level, std::move(said->text));
  } else {
    ended_ = true;
    ended_timer_.cancel();
  }
}

// A thread that ended is joined; one that hangs owns all it uses and ends when it can.
void Publisher::leave() {
  if (ended_) {
    thread_.join();
  } else {
    thread_.detach();
  }
}

namespace {

int number_of(config::MqttVersion version) noexcept {
  switch (version) {
    case config::MqttVersion::v5:
      return 5;
    case config::MqttVersion::v3_1_1:
      return 4;
    case config::MqttVersion::automatic:
      break;
  }
  return 0;
}

}  // namespace

PublisherSettings publisher_settings(const config::Mqtt& mqtt, const config::Gateway& gateway) {
  PublisherSettings settings;
  settings.broker = mqtt.brokers.front();
  settings.version = number_of(mqtt.version);
  settings.client.client_id = mqtt.client_id.empty() ? "canopen-gateway-" + gateway.name : mqtt.client_id;
  settings.client.username = mqtt.username;
  settings.client.password = mqtt.password;
  settings.client.will_topic = status_topic(mqtt.base, gateway.name);
  settings.client.will_payload = "offline";
  settings.client.qos = mqtt.qos;
  return settings;
}

std::unique_ptr<Broker> make_publisher(boost::asio::any_io_executor executor, const config::Mqtt& mqtt,
                                       const config::Gateway& gateway, Notice notice) {
  return std::make_unique<Publisher>(std::move(executor), publisher_settings(mqtt, gateway), std::move(notice));
}

}  // namespace mqtt
