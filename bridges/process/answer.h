#pragma once

#include <cstdint>
#include <string_view>

#include "canopen/error.h"

namespace process {

/// How a failed command is told to each kind of client.
struct Answer {
  std::uint8_t modbus_exception;  ///< 0x01, 0x02, 0x03, 0x04 or 0x0B.
  std::string_view mqtt_code;     ///< `range`, `offline`, …
};

/// The one table from errors to answers.
[[nodiscard]] Answer answer_of(canopen::ErrorKind kind) noexcept;

}  // namespace process
