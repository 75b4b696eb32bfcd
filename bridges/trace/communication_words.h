#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "canopen/object.h"

namespace trace {

/// What CiA 301 calls an object of the communication profile (0x1000..0x1FFF): `producer heartbeat time`, `TPDO2
/// mapping, object 1`; empty for one that it does not name.
[[nodiscard]] std::string communication_name(canopen::ObjectAddress object);

/// The value of such an object in words: `500 ms`, `0x185, switched off`, `0x2021:02, 16 bits`. Empty where there is
/// nothing to say beyond the number, and where the bytes are too few.
[[nodiscard]] std::string communication_value(canopen::ObjectAddress object, std::span<const std::uint8_t> value);

}  // namespace trace
