#include "bridges/mqtt/traffic.h"

#include <algorithm>

namespace mqtt {
namespace {

using namespace std::chrono_literals;

// Nothing that was sent is acknowledged for this long: the broker hangs, although TCP stands. Paho's own ping does not
// notice while its socket is full.
constexpr auto kStall = 20s;
constexpr auto kStallCheck = 1s;
// What MQTT adds to topic and payload of a message, at most.
constexpr std::size_t kOverhead = 64;

}  // namespace

Traffic::Traffic(std::size_t outbox_limit, std::shared_ptr<LoopPost> loop)
    : loop_(std::move(loop)), outbox_(outbox_limit) {
  outbox_.hold(true);
}

void Traffic::publish(std::vector<Message> batch) {
  const std::lock_guard lock(mutex_);
  for (Message& message : batch) {
    outbox_.push(std::move(message));
  }
  wake_.notify_one();
}

void Traffic::subscribe(ConnectionId connection, std::vector<Subscription> subscriptions) {
  const std::lock_guard lock(mutex_);
  orders_.push_back({connection, std::move(subscriptions)});
  wake_.notify_one();
}

void Traffic::unsubscribe(ConnectionId connection, std::string filter) {
  const std::lock_guard lock(mutex_);
  unsubscriptions_.emplace_back(connection, std::move(filter));
  wake_.notify_one();
}

BrokerCounts Traffic::counts() {
  const std::lock_guard lock(mutex_);
  return {.messages_dropped = dropped_, .answers_dropped = outbox_.lost_answers()};
}

void Traffic::open(ConnectionId connection) {
  const std::lock_guard lock(mutex_);
  opened_ = connection;
  if (sends()) {
    outbox_.hold(false);
    wake_.notify_one();
  }
}

void Traffic::finish(std::vector<Message> last, std::chrono::milliseconds patience) {
  const std::lock_guard lock(mutex_);
  outbox_.hold(true);
  has_last_words_ = !last.empty();
  for (Message& message : last) {
    outbox_.push(std::move(message));
  }
  finishing_ = true;
  finish_by_ = Clock::now() + patience;
  wake_.notify_one();
}

std::optional<ConnectionId> Traffic::begin() {
  const std::lock_guard lock(mutex_);
  if (finishing_) {
    return std::nullopt;
  }
  link_ = Link::connecting;
  refusal_ = -1;
  return ++connection_;
}

std::optional<int> Traffic::await_connection(std::chrono::milliseconds patience) {
  std::unique_lock lock(mutex_);
  wake_.wait_for(lock, patience, [this] { return link_ != Link::connecting || finishing_; });
  if (link_ != Link::up) {
    return refusal_;
  }
  progress_ = Clock::now();
  return std::nullopt;
}

Traffic::Work Traffic::await_work() {
  std::unique_lock lock(mutex_);
  wake_.wait_for(lock, kStallCheck, [this] { return has_work(); });
  Work work;
  if (link_ != Link::up) {
    work.over = "the connection broke";
    return work;
  }
  if (!in_flight_.empty() && Clock::now() - progress_ > kStall) {
    work.over = "the broker acknowledges nothing any more";
    return work;
  }
  for (Ordered& ordered : orders_) {
    if (ordered.connection == connection_) {
      work.subscriptions.push_back(std::move(ordered.subscriptions));
    }
  }
  orders_.clear();
  for (auto& [connection, filter] : unsubscriptions_) {
    if (connection == connection_) {
      work.unsubscriptions.push_back(std::move(filter));
    }
  }
  unsubscriptions_.clear();
  take_messages(work);
  work.farewell = finishing_ && farewell_over();
  work.all_said = work.farewell && has_last_words_ && all_said();
  return work;
}

void Traffic::unfit(const InFlight* message) {
  const std::lock_guard lock(mutex_);
  erase(message);
  ++dropped_;
}

void Traffic::broken() {
  on_down();
}

void Traffic::end() {
  const std::lock_guard lock(mutex_);
  link_ = Link::none;
  outbox_.hold(true);
  orders_.clear();
  for (auto entry = in_flight_.rbegin(); entry != in_flight_.rend(); ++entry) {
    if (entry->answer) {
      outbox_.put_back(std::move(*entry->answer));
    }
  }
  in_flight_.clear();
  if (outbox_.lost_answers() != said_lost_) {
    said_lost_ = outbox_.lost_answers();
    loop_->post(Said{Level::warning, "MQTT: answers lost because the broker was away or slow: " +
                                         std::to_string(said_lost_) + " since the start"});
  }
}

bool Traffic::pause(std::chrono::milliseconds duration) {
  std::unique_lock lock(mutex_);
  return !wake_.wait_for(lock, duration, [this] { return finishing_; });
}

bool Traffic::finishing() {
  const std::lock_guard lock(mutex_);
  return finishing_;
}

void Traffic::on_up(BrokerLimits limits) noexcept {
  const std::lock_guard lock(mutex_);
  if (link_ == Link::connecting) {
    link_ = Link::up;
    limits_ = limits;
  }
  wake_.notify_one();
}

void Traffic::on_refused(int code) noexcept {
  const std::lock_guard lock(mutex_);
  if (link_ == Link::connecting) {
    link_ = Link::refused;
    refusal_ = code;
  }
  wake_.notify_one();
}

void Traffic::on_down() noexcept {
  const std::lock_guard lock(mutex_);
  link_ = Link::down;
  wake_.notify_one();
}

void Traffic::on_incoming(Incoming&& message) noexcept {
  loop_->post(std::move(message));
}

void Traffic::on_sent(const InFlight* message, Delivery delivery) noexcept {
  const std::lock_guard lock(mutex_);
  if (delivery == Delivery::failed) {
    return;  // the connection is going: end() takes care of an answer
  }
  if (delivery == Delivery::refused && !std::exchange(said_refused_, true)) {
    loop_->post(Said{Level::error,
                     "MQTT: the broker refuses some of what is published; check what the gateway's user may write"});
  }
  dropped_ += delivery == Delivery::refused ? 1 : 0;
  erase(message);
  progress_ = Clock::now();
  wake_.notify_one();
}

void Traffic::on_subscribed(Subscribed&& subscribed) noexcept {
  const std::lock_guard lock(mutex_);
  if (link_ == Link::up) {  // else it failed because the connection went
    loop_->post(std::move(subscribed));
  }
}

bool Traffic::sends() const {
  return link_ == Link::up && opened_ == connection_;
}

bool Traffic::all_said() const {
  return sends() && outbox_.empty() && in_flight_.empty();
}

bool Traffic::farewell_over() const {
  return !sends() || all_said() || Clock::now() >= finish_by_;
}

bool Traffic::has_work() const {
  const bool can_send = sends() && !outbox_.empty() && in_flight_.size() < limits_.window;
  return link_ != Link::up || !orders_.empty() || !unsubscriptions_.empty() || can_send ||
         (finishing_ && farewell_over());
}

void Traffic::take_messages(Work& work) {
  while (sends() && in_flight_.size() < limits_.window) {
    std::optional<Message> message = outbox_.pop();
    if (!message) {
      return;
    }
    const std::size_t size = message->topic.size() + message->payload.size() + kOverhead;
    if (limits_.packet == 0 || size <= limits_.packet) {
      if (in_flight_.empty()) {
        progress_ = Clock::now();
      }
      work.messages.emplace_back(std::move(*message), &in_flight_.emplace_back());
    } else if (++dropped_; !std::exchange(said_too_long_, true)) {
      loop_->post(Said{Level::error, "MQTT: the broker takes messages of " + std::to_string(limits_.packet) +
                                         " bytes at most; " + message->topic + " is longer and is not published"});
    }
  }
}

void Traffic::erase(const InFlight* message) {
  const auto entry =
      std::find_if(in_flight_.begin(), in_flight_.end(), [message](const InFlight& each) { return &each == message; });
  if (entry != in_flight_.end()) {
    in_flight_.erase(entry);
  }
}

}  // namespace mqtt
