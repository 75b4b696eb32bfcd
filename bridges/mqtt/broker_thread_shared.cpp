// What the loop and Paho's threads tell the broker's thread; all of it takes the lock.

#include <algorithm>
#include <utility>

#include "bridges/mqtt/broker_thread.h"
#include "bridges/mqtt/reasons.h"
#include "bridges/mqtt/topics.h"

namespace mqtt {

void BrokerThread::publish(std::vector<Message> batch) {
  const std::lock_guard lock(mutex_);
  if (finishing_) {
    return;  // nothing comes behind the last words
  }
  traffic_.push(std::move(batch), Clock::now());
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
  if (finishing_ || connection != connection_) {
    return;
  }
  traffic_.open(Clock::now());
  wake_.notify_one();
}

void BrokerThread::drop(ConnectionId connection, std::string why) {
  const std::lock_guard lock(mutex_);
  if (connection == connection_ && link_ == Link::up && !finishing_) {
    drop_ = std::move(why);
  }
  wake_.notify_one();
}

void BrokerThread::finish(std::vector<Message> last, std::chrono::milliseconds patience) {
  const std::lock_guard lock(mutex_);
  has_last_words_ = !last.empty();
  traffic_.push(std::move(last), Clock::now());
  finishing_ = true;
  finish_by_ = Clock::now() + patience;
  wake_.notify_one();
}

BrokerCounts BrokerThread::counts() const {
  const std::lock_guard lock(mutex_);
  return traffic_.counts();
}

bool BrokerThread::alive() const {
  const std::lock_guard lock(mutex_);
  const auto now = Clock::now();
  return now < silent_from_ && !(link_ == Link::up && traffic_.stuck(now));
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
  traffic_.acknowledged(message, delivery, code, Clock::now());
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

bool BrokerThread::farewell_over() const {
  return !sends() || traffic_.all_said() || Clock::now() >= finish_by_;
}

bool BrokerThread::has_work() {
  return link_ != Link::up || drop_ || !orders_.empty() || traffic_.may_send(Clock::now()) ||
         (finishing_ && farewell_over());
}

void BrokerThread::note_watched(const Order& order) {
  const std::string& filter = order.subscription.filter;
  std::erase(watched_, filter);  // one that was refused is asked for again and again
  if (order.subscription.watched) {
    watched_.push_back(filter);
  }
}

BrokerThread::End BrokerThread::how_it_ended() const {
  if (stalled_) {
    return {"the broker acknowledges nothing any more"};
  }
  if (down_code_ < 0) {
    return {drop_.value_or("the connection broke")};
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
