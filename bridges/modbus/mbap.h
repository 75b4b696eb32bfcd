#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

// Framing of Modbus TCP (MODBUS Messaging on TCP/IP Implementation Guide V1.0b, section 3.1.3): transaction id,
// protocol id, length (two bytes each), unit id, then the PDU.

namespace modbus {

inline constexpr std::size_t kHeaderSize = 7;
inline constexpr std::size_t kMaxPdu = 253;
inline constexpr std::size_t kMaxFrame = kHeaderSize + kMaxPdu;

enum class Framing : std::uint8_t {
  incomplete,  ///< More bytes are needed.
  complete,
  broken  ///< No Modbus TCP: where the next frame begins can not be told.
};

struct FoundFrame {
  Framing framing = Framing::incomplete;
  std::size_t size = 0;  ///< Of the complete frame, header included: 8..kMaxFrame.
};

/// Two bytes, high byte first; `bytes` holds them.
[[nodiscard]] constexpr std::uint16_t word_at(std::span<const std::uint8_t> bytes, std::size_t at) noexcept {
  return static_cast<std::uint16_t>(bytes[at] << 8 | bytes[at + 1]);
}

/// Looks for the frame at the beginning of `bytes`. Judges as early as it can: a wrong protocol id is broken before the
/// rest has come.
[[nodiscard]] FoundFrame find_frame(std::span<const std::uint8_t> bytes) noexcept;

/// The answer to the request `frame`: its header with `pdu`, at most kMaxPdu bytes, behind it. Returns the part of
/// `out` that it fills.
[[nodiscard]] std::span<const std::uint8_t> frame_answer(std::span<const std::uint8_t> frame,
                                                         std::span<const std::uint8_t> pdu,
                                                         std::span<std::uint8_t, kMaxFrame> out) noexcept;

/// Of a complete frame.
[[nodiscard]] std::uint8_t unit_of(std::span<const std::uint8_t> frame) noexcept;
[[nodiscard]] std::span<const std::uint8_t> pdu_of(std::span<const std::uint8_t> frame) noexcept;

}  // namespace modbus
