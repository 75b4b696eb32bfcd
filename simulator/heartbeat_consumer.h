#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "simulator/alarm.h"
#include "simulator/object_dictionary.h"

namespace simulator {

/// Heartbeat consumer (0x1016): watches a producer from its first heartbeat on (CiA 301 §7.2.8.2.2.2).
class HeartbeatConsumer {
 public:
  /// `lost`: no heartbeat in time. `cleared`: it came back, or the entry was changed. Both with the sub-index and the
  /// producer's node.
  using Action = std::function<void(std::uint8_t sub, std::uint8_t node)>;

  HeartbeatConsumer(boost::asio::any_io_executor executor, Action lost, Action cleared);

  void restore_defaults(std::uint8_t entries);
  void define(ObjectDictionary& dictionary);
  /// Forgets what was heard; entries stay.
  void restart();
  void on_heartbeat(std::uint8_t node);

 private:
  struct Entry {
    std::uint32_t value = 0;  ///< bits 16..23 node, 0..15 ms
    bool lost = false;
    std::unique_ptr<Alarm> alarm;
  };
  [[nodiscard]] Abort set(std::size_t position, std::uint32_t value);
  void expire(std::size_t position);

  boost::asio::any_io_executor executor_;
  Action lost_;
  Action cleared_;
  std::vector<Entry> entries_;
};

}  // namespace simulator
