#pragma once

#include <cstdint>

namespace modbus {

/// Why a request is refused (MODBUS Application Protocol V1.1b3, section 7).
enum class Exception : std::uint8_t {
  illegal_function = 0x01,  ///< Also: this client may not.
  illegal_address = 0x02,
  illegal_value = 0x03,
  device_failure = 0x04,  ///< The drive refused.
  unknown_unit = 0x0A,    ///< Gateway path unavailable: nobody has this unit id.
  no_response = 0x0B      ///< Gateway target device failed to respond: offline, not fresh, or not confirmed in time.
};

}  // namespace modbus
