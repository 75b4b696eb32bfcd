#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <cstdint>
#include <deque>
#include <memory>
#include <string>
#include <vector>

#include "canopen/link.h"

namespace canopen {

class VirtualLink;

/// An in-process CAN bus: every frame one link sends reaches all others, in order, and comes back to the sender as its
/// echo. Delivery runs through the loop, never inside send(). The queue is bounded; a full one answers `busy`.
/// Outlives its links.
class VirtualBus {
 public:
  explicit VirtualBus(boost::asio::any_io_executor executor);
  ~VirtualBus();
  VirtualBus(const VirtualBus&) = delete;
  VirtualBus& operator=(const VirtualBus&) = delete;

  [[nodiscard]] std::unique_ptr<Link> connect();

  /// Tests: a bus that is off or down accepts nothing and tells every link so.
  void set_state(const BusState& state);
  /// Tests: while true, frames are delivered to the others but not echoed to the sender.
  void withhold_echoes(bool withhold) noexcept { withhold_echoes_ = withhold; }

  static constexpr std::size_t kCapacity = 1024;  ///< Frames waiting for delivery.

 private:
  friend class VirtualLink;
  struct Pending {
    const VirtualLink* sender = nullptr;
    Frame frame;
  };

  SendResult accept(const VirtualLink& sender, const Frame& frame);
  void schedule();
  void deliver();
  void deliver_one(const Pending& pending);
  void tell_state(VirtualLink& link);
  void remove(const VirtualLink& link);

  boost::asio::any_io_executor executor_;
  std::vector<VirtualLink*> links_;  ///< Nothing in a place: unplugged during a delivery.
  std::deque<Pending> queue_;
  BusState state_{BusCondition::error_active, 0, 0};
  bool scheduled_ = false;
  bool delivering_ = false;
  bool withhold_echoes_ = false;
  std::shared_ptr<bool> alive_ = std::make_shared<bool>(true);  ///< Tells posted work that the bus is gone.
};

}  // namespace canopen
