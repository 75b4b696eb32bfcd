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
      worker_(std::make_shared<Worker>(std::move(settings), loop_)),
      ended_timer_(executor) {}

Publisher::~Publisher() {
  loop_->close();
  if (thread_.joinable()) {  // not stopped in order: the broker publishes the will
    worker_->traffic().finish({}, std::chrono::milliseconds(0));
    ended_ = worker_->await_end(std::chrono::milliseconds(2000));
    leave();
  }
}

void Publisher::start(BrokerEvents& events) {
  events_ = &events;
  loop_->tell_stops_by([&events](const Incoming& message) { return events.is_stop(message); });
  thread_ = std::thread([worker = worker_] { worker->run(); });
}

void Publisher::subscribe(ConnectionId connection, std::vector<Subscription> subscriptions) {
  worker_->traffic().subscribe(connection, std::move(subscriptions));
}

void Publisher::publish(std::vector<Message> batch) {
  worker_->traffic().publish(std::move(batch));
}

void Publisher::unsubscribe(ConnectionId connection, std::string filter) {
  worker_->traffic().unsubscribe(connection, std::move(filter));
}

BrokerCounts Publisher::counts() const {
  return worker_->traffic().counts();
}

// Not watched yet.
bool Publisher::alive() const {
  return true;
}

void Publisher::open(ConnectionId connection) {
  worker_->traffic().open(connection);
}

boost::asio::awaitable<void> Publisher::stop(std::vector<Message> last) {
  if (thread_.joinable()) {
    worker_->traffic().finish(std::move(last), worker_->settings().farewell);
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

PublisherSettings publisher_settings(const config::Mqtt& mqtt, const config::Gateway& gateway) {
  PublisherSettings settings;
  settings.broker = mqtt.brokers.front();
  settings.connection.client_id = mqtt.client_id.empty() ? "canopen-gateway-" + gateway.name : mqtt.client_id;
  settings.connection.username = mqtt.username;
  settings.connection.password = mqtt.password;
  settings.connection.will_topic = status_topic(mqtt.base, gateway.name);
  settings.connection.will_payload = "offline";
  settings.connection.qos = mqtt.qos;
  return settings;
}

std::unique_ptr<Broker> make_publisher(boost::asio::any_io_executor executor, const config::Mqtt& mqtt,
                                       const config::Gateway& gateway, Notice notice) {
  return std::make_unique<Publisher>(std::move(executor), publisher_settings(mqtt, gateway), std::move(notice));
}

}  // namespace mqtt
