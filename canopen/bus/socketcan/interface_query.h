#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <system_error>

#include "canopen/bus/bus_state.h"
#include "canopen/bus/socketcan/descriptor.h"

namespace canopen::socketcan {

/// What the kernel says of a network interface.
struct Interface {
  int index = 0;
  bool administratively_up = false;
  bool carrier = false;  ///< Gone in bus-off, and while the other end of a pair is down.
  bool echoes = false;   ///< IFF_ECHO: the driver makes the echoes, else the kernel does at hand-over.
  /// Of the controller, where the driver tells it (not of vcan).
  std::optional<BusCondition> condition;
  /// Likewise.
  struct Counters {
    std::uint16_t transmit = 0;
    std::uint16_t receive = 0;
  };
  std::optional<Counters> counters;
};

/// Asks the kernel by name over netlink (RTM_GETLINK); the answer is there when the request returns. While somebody
/// sets up interfaces the kernel lets it wait, usually for less than a millisecond: not for every frame.
class InterfaceQuery {
 public:
  /// Throws std::system_error where there is no netlink socket to be had.
  InterfaceQuery();

  struct Answer {
    std::error_code error;               ///< Set: the kernel did not answer; nothing is known.
    std::optional<Interface> interface;  ///< Nothing: there is no interface of that name.
  };
  [[nodiscard]] Answer ask(const std::string& name);

 private:
  Descriptor socket_;
  std::uint32_t sequence_ = 0;
};

}  // namespace canopen::socketcan
