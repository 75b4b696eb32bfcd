#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "canopen/sdo/expedited.h"

// The segments of data that do not fit into one SDO frame (CiA 301 §7.2.4.3.5, §7.2.4.3.6).

namespace canopen {

inline constexpr std::size_t kSegmentBytes = 7;

[[nodiscard]] SdoFrame upload_segment_request(bool toggle) noexcept;
/// `data` holds at most kSegmentBytes.
[[nodiscard]] SdoFrame download_segment_request(bool toggle, bool last, std::span<const std::uint8_t> data) noexcept;

/// Bit 4 of every segment request and answer.
[[nodiscard]] constexpr bool toggle_of(std::uint8_t first_byte) noexcept {
  return (first_byte & 0x10U) != 0;
}

struct UploadSegment {
  bool last = false;
  std::span<const std::uint8_t> data;
};

/// Nothing where the answer is shorter than the data it announces.
[[nodiscard]] std::optional<UploadSegment> decode_upload_segment(std::span<const std::uint8_t> answer) noexcept;

}  // namespace canopen
