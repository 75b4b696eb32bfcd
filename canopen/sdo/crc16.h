#pragma once

#include <cstdint>
#include <span>

namespace canopen {

/// The check sum of an SDO block transfer over all its data (CiA 301 §7.2.4.3.16): x^16 + x^12 + x^5 + 1, begun with 0.
/// Of the nine characters "123456789" it is 0x31C3.
[[nodiscard]] std::uint16_t crc16(std::span<const std::uint8_t> data) noexcept;

}  // namespace canopen
