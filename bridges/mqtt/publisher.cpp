#include "bridges/mqtt/publisher.h"

#include <boost/asio/redirect_error.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <boost/system/error_code.hpp>
#include <random>
#include <utility>

#include "bridges/mqtt/topics.h"

namespace mqtt {

Publisher::Publisher(boost::asio::any_io_executor executor, PublisherSettings settings, Notice notice)
    : settings_(std::move(settings)),
      notice_(std::move(notice)),
      loop_(std::make_shared<LoopPost>(
          executor, [this](Incoming&& message) { events_->on_message(std::move(message)); }, notice_)),
      pulse_(settings_.quiet),
      traffic_(settings_.client.qos, [this](Level level, std::string text) { say(level, std::move(text)); }),
      rotation_(settings_.brokers.size(),
                {settings_.first_pause, settings_.longest_pause, settings_.pause_after_refusal},
                std::random_device{}()),
      homecoming_(settings_.return_after, settings_.look_interval),
      ended_timer_(executor) {
  for (const config::Endpoint& broker : settings_.brokers) {
    candidates_.emplace_back(broker, settings_.version, settings_.resolver);
  }
}

Publisher::~Publisher() {
  loop_->close();
  if (thread_.joinable()) {
    finish({}, std::chrono::milliseconds(0));
    thread_.join();
  }
}

void Publisher::start(BrokerEvents& events) {
  events_ = &events;
  loop_->tell_stops_by([&events](const Incoming& message) { return events.is_stop(message); });
  thread_ = std::thread([this] { run(); });
}

void Publisher::subscribe(ConnectionId connection, std::vector<Subscription> subscriptions) {
  const Guard lock(mutex_);
  for (Subscription& subscription : subscriptions) {
    if (connection == line_.connection) {
      line_.orders.push_back({std::move(subscription)});
    }
  }
  wake_.notify_one();
}

void Publisher::unsubscribe(ConnectionId connection, std::string filter) {
  const Guard lock(mutex_);
  if (connection == line_.connection) {
    line_.orders.push_back({.subscription = {.filter = std::move(filter)}, .ends = true});
  }
  wake_.notify_one();
}

void Publisher::publish(std::vector<Message> batch) {
  const auto now = Clock::now();
  Lock lock(mutex_);
  if (!finishing_) {  // nothing comes behind the last words
    traffic_.push(std::move(batch), now);
  }
  wake_if_needed(std::move(lock), now);
}

void Publisher::open(ConnectionId connection) {
  const Guard lock(mutex_);
  if (connection == line_.connection && line_.is_up() && !finishing_) {
    traffic_.open();
  }
  wake_.notify_one();
}

void Publisher::drop(ConnectionId connection, std::string why) {
  const Guard lock(mutex_);
  if (connection == line_.connection && line_.is_up() && !finishing_) {
    line_.drop = std::move(why);
  }
  wake_.notify_one();
}

void Publisher::leave(ConnectionId connection, std::vector<Message> last) {
  const Guard lock(mutex_);
  if (connection == line_.connection && line_.is_up() && !line_.leave_by && !finishing_) {
    traffic_.push(std::move(last), Clock::now());
    line_.leave_by = Clock::now() + settings_.farewell;
  }
  wake_.notify_one();
}

void Publisher::suspect_takeover(ConnectionId connection) {
  const Guard lock(mutex_);
  line_.suspects_takeover = line_.suspects_takeover || connection == line_.connection;
}

BrokerCounts Publisher::counts() const {
  const Guard lock(mutex_);
  return traffic_.counts();
}

bool Publisher::alive() const {
  const Guard lock(mutex_);
  return Clock::now() < silent_from_;
}

boost::asio::awaitable<void> Publisher::stop(std::vector<Message> last) {
  if (thread_.joinable()) {
    finish(std::move(last), settings_.farewell);
    ended_timer_.expires_after(kStopLimit);
    boost::system::error_code ignored;
    if (!ended_) {
      co_await ended_timer_.async_wait(boost::asio::redirect_error(boost::asio::use_awaitable, ignored));
    }
    if (ended_) {
      thread_.join();
    }
  }
  loop_->close();
}

bool Publisher::ended() const {
  const Guard lock(mutex_);
  return thread_ends_ || !thread_.joinable();
}

void Publisher::finish(std::vector<Message> last, std::chrono::milliseconds patience) {
  const Guard lock(mutex_);
  has_last_words_ = !last.empty();
  traffic_.push(std::move(last), Clock::now());
  finishing_ = true;
  finish_by_ = Clock::now() + patience;
  wake_.notify_one();
}

void Publisher::on_up(BrokerLimits limits) noexcept {
  const Guard lock(mutex_);
  line_.up(limits);
  wake_.notify_one();
}

void Publisher::on_refused(Refusal refusal) noexcept {
  const Guard lock(mutex_);
  line_.refused(refusal);
  wake_.notify_one();
}

void Publisher::on_down(int code) noexcept {
  const Guard lock(mutex_);
  line_.down(code);
  wake_.notify_one();
}

void Publisher::on_incoming(Incoming&& message) noexcept {
  const Guard lock(mutex_);
  pulse_.heard(Clock::now());
  if (line_.is_watched(message.topic)) {
    loop_->post_watched(std::move(message));
  } else {
    loop_->post_message(std::move(message));
  }
}

void Publisher::on_sent(const Message* message, Delivery delivery, int code) noexcept {
  Lock lock(mutex_);
  const auto now = Clock::now();
  traffic_.acknowledged(message, delivery, code, now);
  if (delivery != Delivery::failed) {
    pulse_.heard(now);
  }
  wake_if_needed(std::move(lock), now);
}

void Publisher::on_subscribed(Subscribed&& subscribed) noexcept {
  const Guard lock(mutex_);
  pulse_.heard(Clock::now());
  if (line_.is_up()) {  // else it failed because the connection went
    loop_->post([this, answer = std::move(subscribed)] { events_->on_subscribed(answer); });
  }
}

void Publisher::on_unsubscribed(const std::string& filter) noexcept {
  const Guard lock(mutex_);
  pulse_.heard(Clock::now());
  if (filter != settings_.pulse_filter) {
    loop_->post([this, filter] { events_->on_unsubscribed(filter); });
  }
}

void Publisher::say(Level level, std::string text) {
  loop_->post([this, level, said = std::move(text)] { notice_(level, said); });
}

PublisherSettings publisher_settings(const config::Mqtt& mqtt, const config::Gateway& gateway) {
  PublisherSettings settings;
  settings.brokers = mqtt.brokers;
  if (mqtt.version != config::MqttVersion::automatic) {
    settings.version = mqtt.version == config::MqttVersion::v5 ? 5 : 4;
  }
  settings.client.client_id = mqtt.client_id.empty() ? "canopen-gateway-" + gateway.name : mqtt.client_id;
  settings.client.username = mqtt.username;
  settings.password_file = mqtt.password_file;
  settings.client.tls = {.ca = mqtt.ca_file, .cert = mqtt.cert_file, .key = mqtt.key_file};
  settings.client.will_topic = status_topic(mqtt.base, gateway.name);
  settings.client.will_payload = "offline";
  settings.pulse_filter = settings.client.will_topic + "/alive";
  settings.client.qos = mqtt.qos;
  return settings;
}

}  // namespace mqtt
