#include "bridges/mqtt/shelf.h"

#include <cstddef>
#include <functional>
#include <numeric>
#include <utility>

namespace mqtt {

void Shelf::open(const std::string& /*client_id*/, const std::string& /*uri*/) {}

void Shelf::close() {
  clear();
}

void Shelf::clear() {
  const std::lock_guard lock(mutex_);
  packets_.clear();
}

bool Shelf::contains_key(const std::string& key) {
  const std::lock_guard lock(mutex_);
  return packets_.contains(key);
}

string_collection Shelf::keys() const {
  const std::lock_guard lock(mutex_);
  string_collection keys;
  for (const auto& [key, packet] : packets_) {
    keys.push_back(key);
  }
  return keys;
}

void Shelf::put(const std::string& key, const std::vector<string_view>& parts) {
  std::string packet;
  packet.reserve(std::transform_reduce(parts.begin(), parts.end(), std::size_t{0}, std::plus<>(),
                                       [](const string_view& part) { return part.size(); }));
  for (const string_view& part : parts) {
    packet.append(part.data(), part.size());
  }
  const std::lock_guard lock(mutex_);
  packets_.insert_or_assign(key, std::move(packet));
}

std::string Shelf::get(const std::string& key) const {
  const std::lock_guard lock(mutex_);
  const auto packet = packets_.find(key);
  if (packet == packets_.end()) {
    throw persistence_exception();
  }
  return packet->second;
}

void Shelf::remove(const std::string& key) {
  const std::lock_guard lock(mutex_);
  packets_.erase(key);
}

}  // namespace mqtt
