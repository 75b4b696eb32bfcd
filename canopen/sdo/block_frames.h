#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "canopen/object.h"
#include "canopen/sdo/frames.h"

// The frames of SDO block transfer (CiA 301 §7.2.4.3.9 to §7.2.4.3.15). What is read here has 8 bytes.

namespace canopen {

/// Segments of a sub-block, CiA 301 §7.2.4.3.9.
inline constexpr std::uint8_t kMostBlockSegments = 127;

/// Up to so many bytes block transfer takes no fewer frames than segments do.
inline constexpr std::size_t kBlockWorthFrom = 28;

/// What an answer of block transfer is for: bits 1..0 of a download's, bit 0 of an upload's.
enum class BlockAnswer : std::uint8_t { initiate = 0, end = 1, acknowledge = 2, reserved = 3 };

[[nodiscard]] constexpr BlockAnswer block_download_answer_of(std::uint8_t first_byte) noexcept {
  return static_cast<BlockAnswer>(first_byte & 0x03U);
}
[[nodiscard]] constexpr BlockAnswer block_upload_answer_of(std::uint8_t first_byte) noexcept {
  return static_cast<BlockAnswer>(first_byte & 0x01U);
}

[[nodiscard]] SdoFrame block_download_request(ObjectAddress object, std::uint32_t size) noexcept;
/// `most_segments`: of a sub-block. Up to `switch_size` bytes the server may answer as to an upload in segments.
[[nodiscard]] SdoFrame block_upload_request(ObjectAddress object, std::uint8_t most_segments,
                                            std::uint8_t switch_size) noexcept;
[[nodiscard]] SdoFrame block_upload_start() noexcept;
/// Of either direction. `number`: 1..127; `data`: at most kSegmentBytes.
[[nodiscard]] SdoFrame block_segment(std::uint8_t number, bool last, std::span<const std::uint8_t> data) noexcept;
/// Segments up to `number` came in order; the next sub-block may have `most_segments`.
[[nodiscard]] SdoFrame block_upload_acknowledge(std::uint8_t number, std::uint8_t most_segments) noexcept;
/// `unused`: bytes of the last segment that are no data.
[[nodiscard]] SdoFrame block_download_end(std::size_t unused, std::uint16_t crc) noexcept;
[[nodiscard]] SdoFrame block_upload_end() noexcept;

/// The server computes and checks the check sum.
[[nodiscard]] constexpr bool supports_crc(std::uint8_t first_byte) noexcept {
  return (first_byte & 0x04U) != 0;
}

struct BlockSegment {
  std::uint8_t number = 0;  ///< 1..127; 0 is none.
  bool last = false;
  std::span<const std::uint8_t> data;
};
[[nodiscard]] BlockSegment decode_block_segment(std::span<const std::uint8_t> frame) noexcept;

struct BlockUploadEnd {
  std::size_t unused = 0;  ///< Bytes of the last segment that are no data.
  std::uint16_t crc = 0;
};
[[nodiscard]] BlockUploadEnd decode_block_upload_end(std::span<const std::uint8_t> frame) noexcept;

}  // namespace canopen
