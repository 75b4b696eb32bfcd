#include "bridges/mqtt/traffic.h"

#include <algorithm>

#include "bridges/mqtt/reasons.h"

namespace mqtt {
namespace {

constexpr std::size_t kMaxTopicsSaid = 1000;

// Bytes of a length (Variable Byte Integer, MQTT 5 §1.5.5).
std::size_t length_of_length(std::size_t length) {
  std::size_t bytes = 1;
  for (; length >= 0x80; length >>= 7U) {
    ++bytes;
  }
  return bytes;
}

}  // namespace

std::size_t packet_size(const Message& message, int version, int qos) {
  constexpr std::size_t kExpiry = 5;
  constexpr std::size_t kCorrelation = 3;
  std::size_t rest = 2 + message.topic.size() + (qos > 0 ? 2U : 0U) + message.payload.size();
  if (version >= 5) {
    const std::size_t given =
        (message.expiry != 0 ? kExpiry : 0) + (message.correlation ? kCorrelation + message.correlation->size() : 0);
    rest += length_of_length(given) + given;
  }
  return 1 + length_of_length(rest) + rest;
}

void Traffic::push(std::vector<Message> batch, TimePoint now) {
  outbox_.push(std::move(batch), now);
}

void Traffic::begin(const BrokerLimits& limits, int version, TimePoint now) {
  limits_ = limits;
  version_ = version;
  open_ = false;
  begun_ = false;
  progress_ = now;
}

void Traffic::end(bool unexplained, TimePoint now) {
  open_ = false;
  std::vector<const Message*> messages;
  for (const Outbox::Item& item : under_way_) {
    messages.push_back(&item.message);
  }
  if (!unexplained) {
    suspects_->forget();  // one that is never acknowledged must not hold up the others each time
  } else if (const auto held = suspects_->broke(messages, left_, now)) {
    ++dropped_;
    say(*held);
  }
  outbox_.forget_retained();
  for (Outbox::Item& item : under_way_) {
    if (item.message.kind == MessageKind::answer) {
      outbox_.put_back(std::move(item), now);
    }
  }
  under_way_.clear();
  if (outbox_.answers_dropped() != said_answers_) {
    said_answers_ = outbox_.answers_dropped();
    notice_(Level::warning, "MQTT: answers dropped because the broker was away, slow, or closed the connection: " +
                                std::to_string(said_answers_) + " since the start");
  }
}

bool Traffic::may_send(TimePoint now) {
  const Message* const next = has_room() ? front(now) : nullptr;
  return next != nullptr && may_join(*next);
}

bool Traffic::may_join(const Message& next) const {
  return under_way_.empty() || (!suspects_->leaves_alone(next) && !suspects_->leaves_alone(under_way_.front().message));
}

const Message* Traffic::next(TimePoint now) {
  const auto may_leave = [this](const Message& next) { return may_join(next); };
  while (std::optional<Outbox::Item> item = has_room() ? outbox_.pop(now, holds(now), may_leave) : std::nullopt) {
    left_ = now;
    if (fits(item->message)) {
      progress_ = under_way_.empty() ? now : progress_;
      return &under_way_.emplace_back(std::move(*item)).message;
    }
    ++dropped_;
  }
  return nullptr;
}

void Traffic::unfit(const Message* message) {
  under_way_.erase(find(message));
  ++dropped_;
}

void Traffic::not_sent(const Message* message, TimePoint now) {
  const auto item = find(message);
  if (item->message.kind == MessageKind::answer) {
    --item->tries;
    outbox_.put_back(std::move(*item), now);
  }
  under_way_.erase(item);  // what is retained goes with the connection
}

void Traffic::acknowledged(const Message* message, Delivery delivery, int code, TimePoint now) {
  const auto sent = find(message);
  if (sent == under_way_.end() || delivery == Delivery::failed) {
    return;  // where the connection is going, end() takes care of an answer
  }
  if (delivery == Delivery::refused) {
    ++dropped_;
    if (said_refused_.insert(code).second) {
      notice_(Level::error, "MQTT: the broker refuses some of what is published, " + sent->message.topic +
                                " first: " + reason_text(code) + "; check what the gateway's user may write");
    }
  }
  published_ += delivery == Delivery::refused ? 0 : 1;
  begun_ = begun_ || sent->message.after_all;
  suspects_->acquit(sent->message);
  under_way_.erase(sent);
  progress_ = now;
}

bool Traffic::stalled(TimePoint now, std::chrono::milliseconds patience) const {
  return now > stalled_at(patience);
}

Traffic::TimePoint Traffic::stalled_at(std::chrono::milliseconds patience) const {
  if (under_way_.empty()) {
    return TimePoint::max();
  }
  // It is the first to arrive whole; what is acknowledged before it does not stall.
  const std::size_t bytes = packet_size(under_way_.front().message, version_, qos_);
  return progress_ + patience + std::chrono::milliseconds(bytes * 1000 / kSlowestLine);
}

BrokerCounts Traffic::counts() const {
  return {.published = published_, .messages_dropped = dropped_, .answers_dropped = outbox_.answers_dropped()};
}

Outbox::Holds Traffic::holds(TimePoint now) const {
  return [this, now](const Message& message) { return suspects_->holds_back(message, begun_, now); };
}

std::list<Outbox::Item>::iterator Traffic::find(const Message* message) {
  return std::find_if(under_way_.begin(), under_way_.end(),
                      [message](const Outbox::Item& each) { return &each.message == message; });
}

bool Traffic::fits(const Message& message) {
  if (limits_.packet == 0 || packet_size(message, version_, qos_) <= limits_.packet) {
    return true;
  }
  if (said_too_long_.size() < kMaxTopicsSaid && said_too_long_.insert(message.topic).second) {
    notice_(Level::error, "MQTT: the broker takes packets of " + std::to_string(limits_.packet) +
                              " bytes at most; that of " + message.topic + " is longer and is not published");
  }
  return false;
}

void Traffic::say(const Suspects::Verdict& held) const {
  const std::string text =
      "MQTT: the broker ends the connection where " + held.topic + " is published; it is held back ";
  const std::string hold = std::to_string(held.hold.count()) + " s";
  if (held.times == 1) {
    notice_(Level::warning, text + "until it changes, at most for " + hold);
  } else if (held.times == 2) {
    notice_(Level::error, text + "for " + hold + ", then for longer each time; check what the gateway's user may " +
                              "write, and how long a message the broker takes");
  }
}

}  // namespace mqtt
