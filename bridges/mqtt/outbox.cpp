#include "bridges/mqtt/outbox.h"

#include <algorithm>

namespace mqtt {
namespace {

std::size_t size_of(const Message& message) {
  return message.topic.size() + message.payload.size() + (message.correlation ? message.correlation->size() : 0);
}

}  // namespace

void Outbox::push(std::vector<Message> batch, TimePoint now) {
  ++batch_;
  drop_old_answers(now);
  for (Message& message : batch) {
    if (message.kind == MessageKind::answer) {
      push_answer(std::move(message), ++place_, now, 0);
    } else {
      push_newest(std::move(message), now);
    }
  }
}

Outbox::Queue::iterator Outbox::first(TimePoint now, const Holds& holds) {
  drop_old_answers(now);
  const auto held = [&holds](const Waiting& waiting) { return holds && holds(waiting.messages.front()); };
  return std::find_if(waiting_.begin(), waiting_.end(), [&](const auto& each) {
    const auto goes_before = [&](const auto& other) {
      return other.first.second < each.first.second && !held(other.second);
    };
    return !held(each.second) &&
           (!each.second.messages.front().after_all || std::none_of(waiting_.begin(), waiting_.end(), goes_before));
  });
}

const Message* Outbox::front(TimePoint now, const Holds& holds) {
  const auto next = first(now, holds);
  return next == waiting_.end() ? nullptr : &next->second.messages.front();
}

std::optional<Outbox::Item> Outbox::pop(TimePoint now, const Holds& holds, const Holds& may_leave) {
  const auto next = first(now, holds);
  if (next == waiting_.end() || (may_leave && !may_leave(next->second.messages.front()))) {
    return std::nullopt;
  }
  Waiting& waiting = next->second;
  Item item{std::move(waiting.messages.front()), next->first.second, waiting.arrived, waiting.tries + 1};
  if (item.message.kind == MessageKind::answer) {
    --answers_;
    answer_bytes_ -= size_of(item.message);
  } else if (waiting.messages.size() > 1) {
    waiting.messages.pop_front();
    return item;
  } else {
    newest_.erase(item.message.topic);
  }
  waiting_.erase(next);
  return item;
}

void Outbox::put_back(Item answer, TimePoint now) {
  if (answer.tries >= kAnswerTries || now - answer.arrived > kAnswerAge) {
    ++answers_dropped_;
    return;
  }
  push_answer(std::move(answer.message), answer.place, answer.arrived, answer.tries);
}

void Outbox::forget_retained() {
  newest_.clear();
  for (auto waiting = waiting_.begin(); waiting != waiting_.end();) {
    waiting = waiting->first.first == MessageKind::answer ? std::next(waiting) : waiting_.erase(waiting);
  }
}

void Outbox::push_newest(Message message, TimePoint now) {
  const auto known = newest_.find(message.topic);
  if (known != newest_.end() && message.after_all) {
    waiting_.erase(known->second);
  }
  if (known == newest_.end() || message.after_all) {
    const Key key(message.kind, ++place_);
    newest_.insert_or_assign(message.topic, key);
    Waiting& added = waiting_[key];
    added.batch = batch_;
    added.arrived = now;
    added.messages.push_back(std::move(message));
    return;
  }
  auto entry = waiting_.extract(known->second);
  known->second.first = message.kind;
  entry.key() = known->second;
  Waiting& waiting = entry.mapped();
  message.after_all = waiting.messages.back().after_all;
  if (waiting.batch != batch_) {
    waiting.messages.clear();
  }
  waiting.messages.push_back(std::move(message));
  waiting_.insert(std::move(entry));
}

void Outbox::push_answer(Message message, std::uint64_t place, TimePoint arrived, int tries) {
  ++answers_;
  answer_bytes_ += size_of(message);
  Waiting& added = waiting_[{MessageKind::answer, place}];
  added.arrived = arrived;
  added.tries = tries;
  added.messages.push_back(std::move(message));
  while (answers_ > kMaxAnswers || answer_bytes_ > kMaxAnswerBytes) {
    drop_answer(waiting_.lower_bound({MessageKind::answer, 0}));
  }
}

void Outbox::drop_old_answers(TimePoint now) {
  while (answers_ > 0) {
    const auto oldest = waiting_.lower_bound({MessageKind::answer, 0});
    if (now - oldest->second.arrived <= kAnswerAge) {
      return;
    }
    drop_answer(oldest);
  }
}

void Outbox::drop_answer(Queue::iterator answer) {
  --answers_;
  answer_bytes_ -= size_of(answer->second.messages.front());
  ++answers_dropped_;
  waiting_.erase(answer);
}

}  // namespace mqtt
