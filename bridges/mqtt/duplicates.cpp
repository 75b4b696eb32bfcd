#include "bridges/mqtt/duplicates.h"

#include <utility>

namespace mqtt {
namespace {

// Length before text, so that no two commands make one key.
void append_part(std::string& key, std::string_view part) {
  key += std::to_string(part.size());
  key += ':';
  key += part;
}

std::string key_of(const Incoming& command) {
  std::string key;
  append_part(key, command.topic);
  append_part(key, command.payload);
  append_part(key, command.response_topic);
  append_part(key, command.correlation.value_or(""));
  return key;
}

}  // namespace

bool Duplicates::seen(const Incoming& command, bool has_id, canopen::TimePoint now) {
  while (!entries_.empty() && now - entries_.front().at >= kMemory) {
    forget_oldest();
  }
  std::string key = key_of(command);
  if (keys_.contains(key)) {
    // A repetition that passes for a new command (no id) is remembered by its first coming: good enough for DUP.
    return has_id || command.correlation.has_value() || command.redelivered;
  }
  bytes_ += key.size();
  const auto added = keys_.insert(std::move(key)).first;
  entries_.push_back({now, *added});
  while (bytes_ > kCapacity) {
    forget_oldest();
  }
  return false;
}

void Duplicates::forget_oldest() {
  const std::string key(entries_.front().key);
  entries_.pop_front();
  bytes_ -= key.size();
  keys_.erase(key);
}

}  // namespace mqtt
