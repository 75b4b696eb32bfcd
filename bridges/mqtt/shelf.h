#pragma once

#include <mqtt/exception.h>
#include <mqtt/iclient_persistence.h>

#include <map>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

namespace mqtt {

/// Holds for one client, in memory, what it has not yet sent or not yet seen acknowledged. Gone with the client.
///
/// Paho C 1.3.12 frees what waits in a client that is destroyed, but for topic and payload: it takes them to be those
/// of messages on their way, and nobody frees them. With a place to keep them it puts them there and holds neither.
class Shelf final : public iclient_persistence {
 public:
  void open(const std::string& /*client_id*/, const std::string& /*uri*/) override {}
  void close() override { clear(); }
  void clear() override {
    const std::lock_guard lock(mutex_);
    packets_.clear();
  }
  [[nodiscard]] bool contains_key(const std::string& key) override {
    const std::lock_guard lock(mutex_);
    return packets_.contains(key);
  }
  [[nodiscard]] string_collection keys() const override {
    const std::lock_guard lock(mutex_);
    string_collection keys;
    for (const auto& [key, packet] : packets_) {
      keys.push_back(key);
    }
    return keys;
  }
  void put(const std::string& key, const std::vector<string_view>& parts) override {
    std::string packet;
    for (const string_view& part : parts) {
      packet.append(part.data(), part.size());
    }
    const std::lock_guard lock(mutex_);
    packets_.insert_or_assign(key, std::move(packet));
  }
  /// Throws persistence_exception where there is none.
  [[nodiscard]] std::string get(const std::string& key) const override {
    const std::lock_guard lock(mutex_);
    const auto packet = packets_.find(key);
    return packet != packets_.end() ? packet->second : throw persistence_exception();
  }
  void remove(const std::string& key) override {
    const std::lock_guard lock(mutex_);
    packets_.erase(key);
  }

 private:
  mutable std::mutex mutex_;  ///< Paho calls from its threads and from that which publishes.
  std::map<std::string, std::string> packets_;
};

}  // namespace mqtt
