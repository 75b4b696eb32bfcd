#pragma once

#include <cstdint>

namespace canopen {

/// How many stuff bits a frame is taken to have. The truth depends on its content.
enum class Stuffing : std::uint8_t {
  /// A tenth of the stuffable bits: about right for process data with their many zero bytes (random data: 1/30). So a
  /// load made of it is an estimate, good to a few percent of itself.
  usual,
  /// One behind the first five equal bits and one behind each four that follow, the stuff bit itself being the first of
  /// the next five: (stuffable - 1) / 4 (Davis, Burns, Bril, Lukkien: CAN schedulability analysis, 2007, section 3.1).
  worst
};

/// Bits that a classic CAN frame occupies on the wire, the pause of three bits behind it included: 47 + 8 per data byte
/// (67 with a 29-bit identifier), and its stuff bits. `data_bytes` is 0..8; a remote request has none.
[[nodiscard]] constexpr std::uint32_t wire_bits(std::uint32_t data_bytes, Stuffing stuffing,
                                                bool extended = false) noexcept {
  const std::uint32_t unstuffed = (extended ? 67U : 47U) + 8U * data_bytes;
  // Stuffed from start of frame to the CRC sequence: all but CRC delimiter, ACK, end of frame and the pause (ISO
  // 11898-1).
  const std::uint32_t stuffable = unstuffed - 13U;
  return unstuffed + (stuffing == Stuffing::worst ? (stuffable - 1U) / 4U : stuffable / 10U);
}

}  // namespace canopen
