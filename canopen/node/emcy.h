#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

namespace canopen {

/// How a device fills its emergency frame. CiA 301 §7.2.7 fixes only the first three bytes, and not every maker keeps
/// even their meaning.
enum class EmcyLayout : std::uint8_t {
  cia301,             ///< Bytes 0-1 a CiA 301 / CiA 402 code; the text comes from it.
  drive_code,         ///< Bytes 0-1 hold the drive's own fault code; only 0x0000 is an error reset (Veichi).
  class_and_vendor40  ///< Bytes 0-1 a CiA class, bytes 3-7 the drive's fault code, 40 bits little-endian (INVT).
};

struct EmcySettings {
  EmcyLayout layout = EmcyLayout::cia301;
  /// Byte 3 of a 0x0000 frame counts the error sources that are still active (Vacon OPTE6, DPD01091 p. 13).
  bool reset_counts_remaining = false;
  /// CiA 301 code under which the drive puts its own code into the vendor bytes (OPTE6: 0x1000); 0: none.
  std::uint16_t drive_code_under = 0;
  bool enable = false;  ///< 0x1014 may be written while the node is configured, where it differs from 0x80 + node.
  friend bool operator==(const EmcySettings&, const EmcySettings&) = default;
};

/// One emergency message, decoded.
struct Emcy {
  std::uint16_t code = 0;                ///< Bytes 0-1 as sent.
  std::uint8_t error_register = 0;       ///< Byte 2, object 0x1001.
  std::array<std::uint8_t, 5> vendor{};  ///< Bytes 3-7 as sent.
  /// The drive's own fault number, where the layout carries one.
  std::optional<std::uint64_t> drive_code;
  /// An error reset: an error has gone. All clear only where `remaining` is 0 and error_register is 0.
  bool reset = false;
  std::uint8_t remaining = 0;  ///< Error sources still active after a reset, where the device counts them.

  friend bool operator==(const Emcy&, const Emcy&) = default;
};

/// Nothing where the frame is too short to hold a code and a register (3 bytes); missing vendor bytes read as 0.
[[nodiscard]] std::optional<Emcy> decode_emcy(const EmcySettings& settings,
                                              std::span<const std::uint8_t> bytes) noexcept;

}  // namespace canopen
