#pragma once

#include <cstdint>

// COB-IDs of the pre-defined connection set (CiA 301 tables 74 and 75), but for PDOs, which are settings, and SDO
// (sdo/frames.h). A base is without the node id.

namespace canopen {

inline constexpr std::uint32_t kNmtCobId = 0x000;
inline constexpr std::uint32_t kSyncCobId = 0x080;
inline constexpr std::uint32_t kEmcyBase = 0x080;
inline constexpr std::uint32_t kErrorControlBase = 0x700;  ///< Boot-up, heartbeat, guarding.

}  // namespace canopen
