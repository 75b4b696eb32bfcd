#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "canopen/object.h"

/// What the SDO server of the tests puts into frames and takes out of them. Written from CiA 301 alone: it shares
/// nothing with the client it is to test.
namespace support::block {

/// The data of an SDO frame: eight bytes, always (CiA 301 §7.2.4.3).
using Content = std::array<std::uint8_t, 8>;
using Bytes = std::vector<std::uint8_t>;

/// Segments of every kind carry up to seven bytes, after the command byte.
inline constexpr std::size_t kSegmentBytes = 7;
inline constexpr std::uint8_t kMaxBlockSize = 127;
/// The command byte of an abort. As a segment of a sub-block it would have the sequence number 0, which none has.
inline constexpr std::uint8_t kAbortCommand = 0x80;

// Abort codes (CiA 301 §7.2.4.3.17, table 22).
inline constexpr std::uint32_t kToggleBit = 0x05030000;
inline constexpr std::uint32_t kCommandSpecifier = 0x05040001;
inline constexpr std::uint32_t kBlockSize = 0x05040002;
inline constexpr std::uint32_t kSequenceNumber = 0x05040003;
inline constexpr std::uint32_t kCrc = 0x05040004;
inline constexpr std::uint32_t kNoObject = 0x06020000;
inline constexpr std::uint32_t kLength = 0x06070010;
inline constexpr std::uint32_t kLengthTooHigh = 0x06070012;
inline constexpr std::uint32_t kLengthTooLow = 0x06070013;
inline constexpr std::uint32_t kNoSubIndex = 0x06090011;
inline constexpr std::uint32_t kGeneral = 0x08000000;

struct Abort {
  canopen::ObjectAddress object;
  std::uint32_t code = 0;
  friend bool operator==(const Abort&, const Abort&) = default;
};

/// Bits 7..5 of the command byte: ccs or scs.
[[nodiscard]] constexpr unsigned specifier(const Content& content) noexcept {
  return unsigned{content[0]} >> 5U;
}
/// The field of `width` bits that begins at bit `low` of the command byte.
[[nodiscard]] constexpr std::uint8_t field(const Content& content, unsigned low, unsigned width) noexcept {
  return static_cast<std::uint8_t>((unsigned{content[0]} >> low) & ((1U << width) - 1U));
}
/// The object of an initiate and of an abort: index and sub-index in the bytes 1 to 3.
[[nodiscard]] canopen::ObjectAddress multiplexer(const Content& content) noexcept;
/// Little-endian numbers from the byte `at` on.
[[nodiscard]] std::uint16_t get_u16(const Content& content, std::size_t at) noexcept;
[[nodiscard]] std::uint32_t get_u32(const Content& content, std::size_t at) noexcept;
/// Whether the bytes from `first` to the end are 0, as reserved ones have to be.
[[nodiscard]] bool zero_from(const Content& content, std::size_t first) noexcept;

/// A command byte, the rest 0.
[[nodiscard]] Content command(unsigned byte) noexcept;
/// A command byte with the object in the bytes 1 to 3.
[[nodiscard]] Content command(unsigned byte, canopen::ObjectAddress object) noexcept;
void put_u16(Content& content, std::size_t at, std::uint16_t value) noexcept;
void put_u32(Content& content, std::size_t at, std::uint32_t value) noexcept;
[[nodiscard]] Content abort_transfer(const Abort& abort) noexcept;
/// Up to seven bytes of `data` from `offset` on behind the command byte; returns how many.
std::size_t put_segment(Content& content, std::span<const std::uint8_t> data, std::size_t offset) noexcept;

/// The checksum of a block transfer: x^16 + x^12 + x^5 + 1, begun with 0, most significant bit first (CiA 301
/// §7.2.4.3.16).
[[nodiscard]] std::uint16_t crc16(std::span<const std::uint8_t> data) noexcept;

}  // namespace support::block
