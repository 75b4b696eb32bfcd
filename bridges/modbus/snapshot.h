#pragma once

#include <array>
#include <cstdint>

#include "bridges/modbus/request.h"

namespace modbus {

/// What a read found, in one piece. The answer is worded from here, so that one that has to wait for a full socket
/// still tells the values of one moment.
struct Snapshot {
  std::array<std::uint16_t, kMaxReadRegisters> registers{};
  std::array<std::uint8_t, kMaxReadBits> bits{};  ///< One byte each, 0 or 1, as libmodbus has it.
};

}  // namespace modbus
