#pragma once

#include <cstdint>
#include <optional>

#include "simulator/object_dictionary.h"
#include "simulator/traits.h"

namespace simulator {

inline constexpr std::uint16_t kVeichiControlBlock = 0x2030;  ///< addresses 0x3000..; sub-index is the low byte + 1
inline constexpr std::uint16_t kVeichiMonitoring = 0x2021;    ///< C00; sub-index is the number + 1

/// Services and default PDOs of the AC300CAN1 card.
[[nodiscard]] Traits veichi_traits(bool pdo_objects);

/// The object's group and number, and whether it is the one that is kept in EEPROM.
struct VeichiParameter {
  std::uint16_t parameter;  ///< group times 256 plus number: F01.05 is 0x0105
  bool stored;
};

[[nodiscard]] std::optional<VeichiParameter> veichi_parameter(Address address);

}  // namespace simulator
