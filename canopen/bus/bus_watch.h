#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "canopen/bus/bus_state.h"
#include "canopen/bus/second_master.h"
#include "canopen/bus/subscription.h"
#include "canopen/clock.h"
#include "canopen/wake_up.h"

namespace canopen {

class Bus;
struct NodeSettings;
struct Received;

/// Looks after who else is on a bus, how full it is, and whether frames of ours leave: only by what is heard anyway, it
/// sends nothing.
class BusWatch {
 public:
  struct Handlers {
    std::function<void(const BusTroubles&)> changed;
    std::function<void(const std::string&)> remark;  ///< Of another master that is wanted.
  };

  /// `bus` outlives the watch. `other_master`: another one is wanted; what it does is a remark, and no trouble.
  BusWatch(const boost::asio::any_io_executor& executor, Bus& bus, bool other_master, Handlers handlers);
  BusWatch(const BusWatch&) = delete;
  BusWatch& operator=(const BusWatch&) = delete;
  ~BusWatch() = default;

  /// RPDOs of this node that carry commands are ours to send.
  void watch_commands_to(const NodeSettings& node);
  /// Those of no node, until one is named again.
  void forget_commands() { commands_.clear(); }
  void start();
  void stop() { timer_.cancel(); }

 private:
  void subscribe();
  void on_nmt(const Received& received);
  void hear(MasterSign sign, TimePoint at, std::uint8_t node = 0, std::uint8_t command = 0);
  /// Each fifth of a second: what is too old goes, and the load is looked at.
  void look();
  [[nodiscard]] bool is_overloaded() const;
  [[nodiscard]] TransmitTrouble transmit_trouble() const;
  void tell();

  Bus& bus_;
  bool other_master_;
  Handlers handlers_;
  SecondMaster second_master_;
  std::optional<TimePoint> own_id_at_;  ///< The newest heartbeat of another with our node id, within the minute.
  BusTroubles troubles_;
  WakeUp timer_;
  std::vector<Subscription> subscriptions_;
  std::vector<Subscription> commands_;  ///< To nodes that were named.
};

}  // namespace canopen
