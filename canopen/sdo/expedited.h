#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "canopen/object.h"

// The first exchange of every SDO (CiA 301 §7.2.4.3): expedited transfers consist of nothing else.

namespace canopen {

/// A request always has 8 bytes: some devices refuse shorter ones.
using SdoFrame = std::array<std::uint8_t, 8>;

inline constexpr std::size_t kMaxExpeditedBytes = 4;

/// Bits 7..5 of an answer's first byte (CiA 301 tables 40 to 58).
enum class SdoAnswer : std::uint8_t {
  upload_segment = 0,
  download_segment = 1,
  upload = 2,
  download = 3,
  abort = 4,
  block_download = 5,
  block_upload = 6,
  reserved = 7
};

[[nodiscard]] constexpr SdoAnswer sdo_answer_of(std::uint8_t first_byte) noexcept {
  return static_cast<SdoAnswer>(first_byte >> 5U);
}

/// The address in bytes 1..3; nothing where the answer is shorter.
[[nodiscard]] std::optional<ObjectAddress> address_of(std::span<const std::uint8_t> answer) noexcept;

[[nodiscard]] SdoFrame upload_request(ObjectAddress object) noexcept;
/// Of 1 to 4 bytes.
[[nodiscard]] SdoFrame expedited_download_request(ObjectAddress object, std::span<const std::uint8_t> data) noexcept;
[[nodiscard]] SdoFrame segmented_download_request(ObjectAddress object, std::uint32_t size) noexcept;
[[nodiscard]] SdoFrame abort_request(ObjectAddress object, std::uint32_t code) noexcept;

/// What an answer to an upload request says.
struct UploadAnswer {
  bool expedited = false;
  std::optional<std::uint32_t> size;  ///< Bytes of data; nothing where the device does not tell (0x42, 0x40).
};

[[nodiscard]] UploadAnswer decode_upload_answer(std::span<const std::uint8_t> answer) noexcept;

/// Little-endian; `bytes` holds at least 4.
[[nodiscard]] std::uint32_t decode_u32(std::span<const std::uint8_t> bytes) noexcept;

}  // namespace canopen
