#pragma once

#include <array>
#include <cstdint>

#include "canopen/frame.h"

namespace support {

/// A frame of one byte.
inline canopen::Frame frame(std::uint32_t id, std::uint8_t content = 0) {
  const std::array bytes{content};
  return canopen::make_frame(id, bytes);
}

}  // namespace support
