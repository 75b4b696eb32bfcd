#pragma once

#include <array>
#include <cstdint>

#include "canopen/frame.h"
#include "canopen/nmt.h"

namespace canopen {

/// An NMT command to one node (CiA 301 §7.2.8.3.1): COB-ID 0, command specifier, node id.
[[nodiscard]] inline Frame nmt_frame(NmtCommand command, std::uint8_t node) noexcept {
  return make_frame(0, std::array{static_cast<std::uint8_t>(command), node});
}

}  // namespace canopen
