#pragma once

#include <cstdint>
#include <variant>
#include <vector>

#include "bridges/modbus/exception.h"

namespace modbus {

/// What function 43 is answered with: the PDU, at most kMaxPdu bytes, or an exception. An SDO abort of a drive is a
/// PDU, too.
using EncapsulatedAnswer = std::variant<std::vector<std::uint8_t>, Exception>;

}  // namespace modbus
