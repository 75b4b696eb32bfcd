#include "bridges/mqtt/suspects.h"

#include <algorithm>
#include <functional>

namespace mqtt {
namespace {

std::size_t hash_of(const std::string& payload) {
  return std::hash<std::string>()(payload);
}

std::chrono::seconds hold_of(const Message& message, int times) {
  constexpr int kMaxDoublings = 10;
  return std::min(Suspects::kFirstHold * (1 << std::min(times - 1, kMaxDoublings)),
                  message.kind == MessageKind::value ? Suspects::kLongestHold : Suspects::kLongestHoldOfAlarms);
}

}  // namespace

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
  Held& held = held_[message.topic];
  const int times = held.times + 1;
  const std::chrono::seconds hold = hold_of(message, times);
  held = {.size = message.payload.size(), .hash = hash_of(message.payload), .until = now + hold, .times = times};
  return Verdict{message.topic, times, hold};
}

bool Suspects::leaves_alone(const Message& message) const {
  return message.kind != MessageKind::answer && suspected_.contains(message.topic);
}

bool Suspects::holds_back(const Message& message, bool begun, TimePoint now) const {
  const auto entry = held_.find(message.topic);
  if (entry == held_.end()) {
    return false;
  }
  const Held& held = entry->second;
  const bool same = held.size == message.payload.size() && held.hash == hash_of(message.payload);
  return (!begun && !message.after_all) || (now < held.until && (held.times > 1 || same));
}

void Suspects::acquit(const Message& message) {
  suspected_.erase(message.topic);
  held_.erase(message.topic);
}

}  // namespace mqtt
