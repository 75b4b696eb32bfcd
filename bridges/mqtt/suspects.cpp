#include "bridges/mqtt/suspects.h"

#include <utility>

namespace mqtt {

std::optional<Suspects::Held> Suspects::broke(const std::list<Outbox::Item>& under_way, TimePoint left, TimePoint now) {
  const bool alone = under_way.size() == 1 && leaves_alone(under_way.front().message, now);
  for (const Outbox::Item& item : under_way) {
    if (item.message.kind != MessageKind::answer) {
      suspected_.insert(item.message.topic);
    }
  }
  if (!alone || now - left > kPrompt) {
    return std::nullopt;
  }
  const Message& message = under_way.front().message;
  const auto [entry, first] = convicted_.try_emplace(message.topic);
  const bool told = entry->second.whatever;
  entry->second = {.payload = message.payload, .until = now + kHeldFor, .whatever = !first};
  return told ? std::nullopt : std::optional(Held{message.topic, !first});
}

bool Suspects::leaves_alone(const Message& message, TimePoint now) const {
  return message.kind != MessageKind::answer && suspected_.contains(message.topic) && !holds_back(message, now);
}

bool Suspects::holds_back(const Message& message, TimePoint now) const {
  const auto entry = convicted_.find(message.topic);
  return entry != convicted_.end() && now < entry->second.until &&
         (entry->second.whatever || entry->second.payload == message.payload);
}

void Suspects::keep(Message message) {
  const auto entry = convicted_.find(message.topic);
  entry->second.kept = std::move(message);
}

std::vector<Message> Suspects::release(TimePoint now) {
  std::vector<Message> released;
  for (auto& [topic, conviction] : convicted_) {
    if (conviction.kept && now >= conviction.until) {
      released.push_back(*std::exchange(conviction.kept, std::nullopt));
    }
  }
  return released;
}

void Suspects::forget_kept(const std::vector<Message>& newer) {
  for (const Message& message : newer) {
    if (const auto entry = convicted_.find(message.topic); entry != convicted_.end()) {
      entry->second.kept.reset();
    }
  }
}

void Suspects::forget_kept() {
  for (auto& [topic, conviction] : convicted_) {
    conviction.kept.reset();
  }
}

void Suspects::arrived(const Message& message) {
  suspected_.erase(message.topic);
  convicted_.erase(message.topic);
}

}  // namespace mqtt
