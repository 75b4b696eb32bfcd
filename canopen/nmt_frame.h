#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "canopen/cob_id.h"
#include "canopen/frame.h"
#include "canopen/nmt.h"

namespace canopen {

/// An NMT command to one node (CiA 301 §7.2.8.3.1): COB-ID 0, command specifier, node id.
[[nodiscard]] inline Frame nmt_frame(NmtCommand command, std::uint8_t node) noexcept {
  return make_frame(kNmtCobId, std::array{static_cast<std::uint8_t>(command), node});
}

/// The command specifier of an NMT command that is for this node, or for all; nothing of another frame.
[[nodiscard]] inline std::optional<std::uint8_t> nmt_specifier_for(const Frame& frame, std::uint8_t node) noexcept {
  const auto bytes = frame.bytes();
  const bool ours = frame.id == kNmtCobId && bytes.size() >= 2 && (bytes[1] == 0 || bytes[1] == node);
  return ours ? std::optional(bytes[0]) : std::nullopt;
}

}  // namespace canopen
