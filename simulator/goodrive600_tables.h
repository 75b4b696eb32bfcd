#pragma once

#include <cstdint>

#include "simulator/traits.h"

namespace simulator {

inline constexpr std::uint16_t kGoodriveReturns = 0x2000;  ///< 00..02 parameter channel, 03..0D returns 1..11
inline constexpr std::uint16_t kGoodriveStatus = 0x2001;
inline constexpr std::uint16_t kGoodriveSettings = 0x2100;  ///< 00..02 parameter channel, 03..0D settings 1..11
inline constexpr std::uint16_t kGoodriveControl = 0x2101;

/// Services and PDOs of the Goodrive600's CANopen card.
[[nodiscard]] Traits goodrive600_traits();

}  // namespace simulator
