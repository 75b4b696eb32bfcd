#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "canopen/object.h"

namespace canopen {

/// What counts of an entry of 0x1016 (CiA 301 §7.5.2.19): node id and time. Bits 24..31 are reserved.
inline constexpr Raw kConsumerUsed = 0x00FF'FFFF;

[[nodiscard]] constexpr Raw consumer_node(Raw value) noexcept {
  return (value >> 16U) & 0xFFU;
}

/// In ms.
[[nodiscard]] constexpr Raw consumer_time(Raw value) noexcept {
  return value & 0xFFFFU;
}

/// One entry of the consumer heartbeat table (0x1016): the node id in bits 16..23, the time in ms in bits 0..15; in use
/// where neither is 0 (CiA 301 §7.5.2.19).
struct ConsumerEntry {
  std::uint8_t sub = 1;
  Raw value = 0;
  friend bool operator==(const ConsumerEntry&, const ConsumerEntry&) = default;
};

/// What makes a node watch over `node` for this time.
[[nodiscard]] constexpr Raw consumer_value(std::uint8_t node, Raw milliseconds) noexcept {
  return (Raw{node} << 16U) | (milliseconds & 0xFFFFU);
}

/// How the entries have to be so that exactly one watches over the node of `wanted`: the one that does so already, else
/// one that names it, else the first one that is not in use. Others that name it are cleared, and come first, for a
/// node refuses two of one node id. Entries of other nodes are never touched. Nothing: no entry is left.
[[nodiscard]] std::optional<std::vector<ConsumerEntry>> plan_consumer_table(std::span<const ConsumerEntry> found,
                                                                            Raw wanted);

}  // namespace canopen
