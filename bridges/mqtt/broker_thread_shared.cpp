// What the loop and Paho's threads tell the broker's thread; all of it takes the lock.

#include <algorithm>
#include <utility>

#include "bridges/mqtt/broker_thread.h"
#include "bridges/mqtt/reasons.h"
#include "bridges/mqtt/topics.h"

namespace mqtt {
namespace {

using namespace std::chrono_literals;

// alive(): longest time in which nothing leaves that could.
constexpr auto kNothingLeaves = 60s;
constexpr std::size_t kMaxTopicsSaid = 1000;

}  // namespace

void BrokerThread::publish(std::vector<Message> batch) {
  const std::lock_guard lock(mutex_);
  if (finishing_) {
    return;  // nothing comes behind the last words
  }
  if (outbox_.empty()) {
    left_ = Clock::now();
  }
  outbox_.push(std::move(batch), Clock::now());
  wake_.notify_one();
}

void BrokerThread::subscribe(ConnectionId connection, std::vector<Subscription> subscriptions) {
  const std::lock_guard lock(mutex_);
  for (Subscription& subscription : subscriptions) {
    orders_.push_back({connection, std::move(subscription)});
  }
  wake_.notify_one();
}

void BrokerThread::unsubscribe(ConnectionId connection, std::vector<std::string> filters) {
  const std::lock_guard lock(mutex_);
  for (std::string& filter : filters) {
    orders_.push_back({.connection = connection, .subscription = {.filter = std::move(filter)}, .ends = true});
  }
  wake_.notify_one();
}

void BrokerThread::open(ConnectionId connection) {
  const std::lock_guard lock(mutex_);
  if (finishing_) {
    return;
  }
  opened_ = connection;
  left_ = Clock::now();
  wake_.notify_one();
}

void BrokerThread::drop(ConnectionId connection, std::string why) {
  const std::lock_guard lock(mutex_);
  if (connection == connection_ && link_ == Link::up && !finishing_) {
    drop_ = std::move(why);
  }
  wake_.notify_one();
}

void BrokerThread::suspect_takeover(ConnectionId connection) {
  const std::lock_guard lock(mutex_);
  suspects_takeover_ = suspects_takeover_ || connection == connection_;
}

void BrokerThread::finish(std::vector<Message> last, std::chrono::milliseconds patience) {
  const std::lock_guard lock(mutex_);
  has_last_words_ = !last.empty();
  outbox_.push(std::move(last), Clock::now());
  finishing_ = true;
  finish_by_ = Clock::now() + patience;
  wake_.notify_one();
}

BrokerCounts BrokerThread::counts() const {
  const std::lock_guard lock(mutex_);
  return {.messages_dropped = dropped_, .answers_dropped = outbox_.answers_dropped()};
}

bool BrokerThread::alive() const {
  const std::lock_guard lock(mutex_);
  const auto now = Clock::now();
  const bool can_send = sends() && !outbox_.empty() && in_flight_.size() < limits_.window;
  return now < silent_from_ && !(can_send && now - left_ > kNothingLeaves);
}

void BrokerThread::on_up(BrokerLimits limits) noexcept {
  const std::lock_guard lock(mutex_);
  if (link_ == Link::connecting) {
    link_ = Link::up;
    limits_ = limits;
  }
  wake_.notify_one();
}

void BrokerThread::on_refused(Refusal refusal) noexcept {
  const std::lock_guard lock(mutex_);
  if (link_ == Link::connecting) {
    link_ = Link::refused;
    refusal_ = refusal;
  }
  wake_.notify_one();
}

void BrokerThread::on_down(int code) noexcept {
  const std::lock_guard lock(mutex_);
  link_ = link_ == Link::connecting ? Link::refused : Link::down;
  if (code >= 0) {
    down_code_ = code;
  }
  wake_.notify_one();
}

void BrokerThread::on_incoming(Incoming&& message) noexcept {
  const std::lock_guard lock(mutex_);
  if (std::any_of(watched_.begin(), watched_.end(),
                  [&message](const std::string& filter) { return matches(filter, message.topic); })) {
    loop_->post_watched(std::move(message));
  } else {
    loop_->post(std::move(message));
  }
}

void BrokerThread::on_sent(const Message* message, Delivery delivery, int code) noexcept {
  const std::lock_guard lock(mutex_);
  if (delivery == Delivery::failed) {
    return;  // the connection is going: drop_client() takes care of an answer
  }
  const auto sent = std::find_if(in_flight_.begin(), in_flight_.end(),
                                 [message](const Outbox::Item& each) { return &each.message == message; });
  if (sent == in_flight_.end()) {
    return;
  }
  if (delivery == Delivery::refused) {
    ++dropped_;
    if (said_refused_.insert(code).second) {
      say(Level::error, "MQTT: the broker refuses some of what is published, " + sent->message.topic +
                            " first: " + reason_text(code) + "; check what the gateway's user may write");
    }
  }
  in_flight_.erase(sent);
  progress_ = Clock::now();
  wake_.notify_one();
}

void BrokerThread::on_subscribed(Subscribed&& subscribed) noexcept {
  const std::lock_guard lock(mutex_);
  if (link_ == Link::up) {  // else it failed because the connection went
    loop_->post(std::move(subscribed));
  }
}

void BrokerThread::expect_sign_of_life(std::chrono::milliseconds allowance) {
  silent_from_ = Clock::now() + allowance;
}

bool BrokerThread::sends() const {
  return link_ == Link::up && opened_ == connection_;
}

bool BrokerThread::all_said() const {
  return sends() && outbox_.empty() && in_flight_.empty();
}

bool BrokerThread::farewell_over() const {
  return !sends() || all_said() || Clock::now() >= finish_by_;
}

bool BrokerThread::has_work() const {
  const bool can_send = sends() && !outbox_.empty() && in_flight_.size() < limits_.window;
  return link_ != Link::up || drop_ || !orders_.empty() || can_send || (finishing_ && farewell_over());
}

void BrokerThread::note_watched(const Order& order) {
  const std::string& filter = order.subscription.filter;
  std::erase(watched_, filter);  // one that was refused is asked for again and again
  if (order.subscription.watched || order.subscription.bulk) {
    watched_.push_back(filter);
  }
}

bool BrokerThread::fits(const Message& message) {
  if (limits_.packet == 0 || packet_size(message, version_, settings_.client.qos) <= limits_.packet) {
    return true;
  }
  if (said_too_long_.size() < kMaxTopicsSaid && said_too_long_.insert(message.topic).second) {
    say(Level::error, "MQTT: the broker takes packets of " + std::to_string(limits_.packet) +
                          " bytes at most; that of " + message.topic + " is longer and is not published");
  }
  return false;
}

BrokerThread::End BrokerThread::how_it_ended() const {
  if (stalled_) {
    return {"the broker acknowledges nothing any more"};
  }
  if (down_code_ < 0) {
    return {drop_.value_or("the connection broke"), suspects_takeover_};
  }
  std::string why = "the broker ended the connection: " + reason_text(down_code_);
  if (is_takeover(down_code_)) {
    why += ": another client has the client id " + settings_.client.client_id;
  }
  return {std::move(why), is_takeover(down_code_)};
}

void BrokerThread::say(Level level, std::string text) {
  loop_->post(Said{level, std::move(text)});
}

}  // namespace mqtt
