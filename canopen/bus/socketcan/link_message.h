#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "canopen/bus/bit_timing.h"
#include "canopen/bus/bus_state.h"

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
  std::optional<BitTiming> timing;  ///< Likewise, once it is set up.
};

/// The content of an RTM_NEWLINK message, behind its netlink header. Nothing where it is too short for one; what is
/// damaged inside is left out.
[[nodiscard]] std::optional<Interface> parse_link(std::span<const std::uint8_t> message);

}  // namespace canopen::socketcan
