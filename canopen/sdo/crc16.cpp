#include "canopen/sdo/crc16.h"

namespace canopen {
namespace {

constexpr unsigned kPolynomial = 0x1021;

}  // namespace

std::uint16_t crc16(std::span<const std::uint8_t> data) noexcept {
  unsigned crc = 0;
  for (const std::uint8_t byte : data) {
    crc ^= static_cast<unsigned>(byte) << 8U;
    for (int bit = 0; bit < 8; ++bit) {
      crc = (crc & 0x8000U) != 0 ? (crc << 1U) ^ kPolynomial : crc << 1U;
    }
    crc &= 0xFFFFU;
  }
  return static_cast<std::uint16_t>(crc);
}

}  // namespace canopen
