#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/awaitable.hpp>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>

#include "canopen/bus/link.h"
#include "canopen/clock.h"

// Which nodes are on a bus, by listening alone.

namespace gateway {

struct HeardNode {
  std::uint8_t node = 0;
  std::string by;  ///< `its heartbeat (0x705)`
};

/// The node that sent the frame: boot-up, heartbeat or guarding answer, emergency, TPDO1 to TPDO4, SDO answer of the
/// predefined connection set (CiA 301 §7.3.3). What masters send to nodes (RPDOs, SDO and guarding requests) tells
/// nothing of them.
[[nodiscard]] std::optional<HeardNode> sender_of(const canopen::Frame& frame);

/// Hears a bus.
class NodeWatch final : public canopen::LinkEvents {
 public:
  /// `link` is open while it listens, and outlives it.
  NodeWatch(const boost::asio::any_io_executor& executor, canopen::Link& link);
  ~NodeWatch();
  NodeWatch(const NodeWatch&) = delete;
  NodeWatch& operator=(const NodeWatch&) = delete;

  /// Until the bus was up for that long without a break; then each node that was heard, and by what first. It waits for
  /// a bus that is down. Ends early by stop().
  boost::asio::awaitable<std::map<std::uint8_t, std::string>> listen(canopen::Duration time);
  void stop();

 private:
  void close();
  void on_frames(std::span<const canopen::Received> frames) override;
  void on_echo(const canopen::Received& /*sent*/) override {}
  void on_bus_state(const canopen::BusState& state) override;
  void on_frames_lost(std::uint32_t /*count*/) override {}

  canopen::Link& link_;
  bool open_ = false;
  canopen::Timer timer_;
  std::map<std::uint8_t, std::string> heard_;
  bool up_ = false;
  bool stopped_ = false;
};

}  // namespace gateway
