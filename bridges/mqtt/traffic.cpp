#include "bridges/mqtt/traffic.h"

#include <algorithm>

#include "bridges/mqtt/reasons.h"

namespace mqtt {
namespace {

constexpr std::size_t kMaxTopicsSaid = 1000;

}  // namespace

void Traffic::push(std::vector<Message> batch, TimePoint now) {
  if (outbox_.empty()) {
    left_ = now;
  }
  suspects_.forget_kept(batch);
  outbox_.push(std::move(batch), now);
}

void Traffic::begin(const BrokerLimits& limits, int version, TimePoint now) {
  limits_ = limits;
  version_ = version;
  open_ = false;
  progress_ = now;
}

void Traffic::open(TimePoint now) {
  open_ = true;
  left_ = now;
}

void Traffic::end(bool unexplained, TimePoint now) {
  open_ = false;
  if (unexplained) {
    if (const auto held = suspects_.broke(under_way_, left_, now)) {
      hold_back(*held);
    }
  }
  outbox_.forget_retained();
  suspects_.forget_kept();
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
  const Message* const next = open_ && under_way_.size() < limits_.window ? outbox_.front(now) : nullptr;
  return next != nullptr && (under_way_.empty() || (!suspects_.leaves_alone(*next, now) &&
                                                    !suspects_.leaves_alone(under_way_.front().message, now)));
}

const Message* Traffic::next(TimePoint now) {
  if (std::vector<Message> released = suspects_.release(now); !released.empty()) {
    push(std::move(released), now);
  }
  while (may_send(now)) {
    std::optional<Outbox::Item> item = outbox_.pop(now);
    left_ = now;
    const bool held = suspects_.holds_back(item->message, now);
    if (held || !fits(item->message)) {
      ++dropped_;
      if (held) {
        suspects_.keep(std::move(item->message));
      }
      continue;
    }
    progress_ = under_way_.empty() ? now : progress_;
    return &under_way_.emplace_back(std::move(*item)).message;
  }
  return nullptr;
}

void Traffic::unfit(const Message* message) {
  under_way_.erase(find(message));
  ++dropped_;
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
  suspects_.arrived(sent->message);
  under_way_.erase(sent);
  progress_ = now;
}

bool Traffic::stuck(TimePoint now) const {
  return open_ && !outbox_.empty() && under_way_.size() < limits_.window && now - left_ > kStuck;
}

BrokerCounts Traffic::counts() const {
  return {.messages_dropped = dropped_, .answers_dropped = outbox_.answers_dropped()};
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

void Traffic::hold_back(const Suspects::Held& held) const {
  notice_(Level::error, "MQTT: the broker ends the connection where " + held.topic + " is published; it is held back " +
                            (held.whatever ? "for" : "until it changes, at most for") + " 10 min; check what the " +
                            "gateway's user may write, and how long a message the broker takes");
}

}  // namespace mqtt
