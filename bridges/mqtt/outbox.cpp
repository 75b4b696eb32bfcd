#include "bridges/mqtt/outbox.h"

#include <algorithm>
#include <utility>

namespace mqtt {

void Outbox::push(Message message) {
  std::size_t& count = count_of(message.kind);
  if (message.kind == MessageKind::answer) {
    if (count >= limit_) {
      drop_oldest_answer();
    }
    ++count;
    queue_.push_back(std::move(message));
    return;
  }
  const auto known = newest_.find(message.topic);
  if (known != newest_.end()) {
    const Queue::iterator older = known->second;
    if (!held_ && count >= limit_) {
      older->payload = std::move(message.payload);
      return;
    }
    newest_.erase(known);  // its key belongs to the older message
    if (held_) {
      erase(older);
    }
  }
  ++count;
  queue_.push_back(std::move(message));
  const auto added = std::prev(queue_.end());
  newest_.emplace(added->topic, added);
}

void Outbox::put_back(Message answer) {
  if (answers_ >= limit_) {
    ++lost_answers_;  // it is the oldest of all
    return;
  }
  ++answers_;
  queue_.push_front(std::move(answer));
}

std::optional<Message> Outbox::pop() {
  if (queue_.empty()) {
    return std::nullopt;
  }
  const auto front = queue_.begin();
  --count_of(front->kind);
  const auto known = newest_.find(front->topic);
  if (known != newest_.end() && known->second == front) {
    newest_.erase(known);
  }
  Message message = std::move(*front);
  queue_.pop_front();
  return message;
}

void Outbox::hold(bool held) {
  held_ = held;
  if (!held) {
    return;
  }
  for (auto message = queue_.begin(); message != queue_.end();) {
    const auto current = message++;
    if (current->kind != MessageKind::answer && newest_.at(current->topic) != current) {
      erase(current);
    }
  }
}

std::size_t& Outbox::count_of(MessageKind kind) noexcept {
  switch (kind) {
    case MessageKind::status:
    case MessageKind::value:
      return values_;
    case MessageKind::alarm:
      return alarms_;
    case MessageKind::answer:
      break;
  }
  return answers_;
}

void Outbox::drop_oldest_answer() {
  const auto oldest = std::find_if(queue_.begin(), queue_.end(),
                                   [](const Message& message) { return message.kind == MessageKind::answer; });
  if (oldest != queue_.end()) {
    erase(oldest);
    ++lost_answers_;
  }
}

void Outbox::erase(Queue::iterator message) {
  --count_of(message->kind);
  queue_.erase(message);
}

}  // namespace mqtt
