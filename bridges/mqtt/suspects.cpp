#include "bridges/mqtt/suspects.h"

namespace mqtt {

std::optional<Suspects::Verdict> Suspects::broke(const std::vector<const Message*>& under_way, TimePoint left,
                                                 TimePoint now) {
  const bool alone = under_way.size() == 1 && leaves_alone(*under_way.front());
  for (const Message* const message : under_way) {
    if (message->kind != MessageKind::answer) {
      suspected_.insert(message->topic);
    }
  }
  if (!alone || now - left > kPrompt) {
    return std::nullopt;
  }
  const Message& message = *under_way.front();
  const auto [entry, first] = held_.try_emplace(message.topic);
  const bool again = entry->second.whatever;
  entry->second = {.payload = message.payload, .until = now + kHeldFor, .whatever = !first};
  return Verdict{message.topic, !first, again};
}

bool Suspects::leaves_alone(const Message& message) const {
  return message.kind != MessageKind::answer && suspected_.contains(message.topic);
}

bool Suspects::holds_back(const Message& message, TimePoint now) const {
  const auto entry = held_.find(message.topic);
  return entry != held_.end() && now < entry->second.until &&
         (entry->second.whatever || entry->second.payload == message.payload);
}

void Suspects::arrived(const Message& message) {
  suspected_.erase(message.topic);
  held_.erase(message.topic);
}

}  // namespace mqtt
