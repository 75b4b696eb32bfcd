#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/awaitable.hpp>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

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

/// Each node that was heard, and by what first.
using HeardNodes = std::map<std::uint8_t, std::string>;

/// Hears buses, all at once.
class NodeWatch {
 public:
  explicit NodeWatch(const boost::asio::any_io_executor& executor);
  ~NodeWatch();
  NodeWatch(const NodeWatch&) = delete;
  NodeWatch& operator=(const NodeWatch&) = delete;

  /// `link` is open while it listens, and outlives it.
  void add(canopen::Link& link);
  /// Until all buses were up for that long, in the same time and without a break; then what was heard on each, in the
  /// order in which they were added. It waits for buses that are down, and hears the others meanwhile; what was heard
  /// on a bus before it was down is forgotten. Ends early by stop().
  boost::asio::awaitable<std::vector<HeardNodes>> listen(canopen::Duration time);
  void stop();

 private:
  class Ear;

  [[nodiscard]] bool all_up() const;
  /// A bus went up or down.
  void begin_anew();

  canopen::Timer timer_;
  std::vector<std::unique_ptr<Ear>> ears_;
  bool broken_ = false;  ///< Since the waiting began.
  bool stopped_ = false;
};

}  // namespace gateway
