#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "canopen/object.h"
#include "canopen/sdo/sdo_settings.h"

// The frames of an SDO (CiA 301 §7.2.4.3), and where real servers depart from them. Our requests always follow the
// standard; they have 8 bytes, for some devices refuse shorter ones. Answers are never empty.

namespace canopen {

using SdoFrame = std::array<std::uint8_t, 8>;

// CiA 301 table 75, default SDO: plus the node id.
inline constexpr std::uint32_t kSdoRequestBase = 0x600;
inline constexpr std::uint32_t kSdoAnswerBase = 0x580;

inline constexpr std::size_t kMaxExpeditedBytes = 4;
inline constexpr std::size_t kSegmentBytes = 7;

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

/// The same of a request.
enum class SdoRequest : std::uint8_t {
  download_segment = 0,
  download = 1,
  upload = 2,
  upload_segment = 3,
  abort = 4,
  block_upload = 5,
  block_download = 6,
  reserved = 7
};

[[nodiscard]] constexpr SdoRequest sdo_request_of(std::uint8_t first_byte) noexcept {
  return static_cast<SdoRequest>(first_byte >> 5U);
}
/// It names an object, and is answered with the same address.
[[nodiscard]] constexpr bool begins_transfer(SdoRequest request) noexcept {
  return request == SdoRequest::download || request == SdoRequest::upload || request == SdoRequest::block_upload ||
         request == SdoRequest::block_download;
}
[[nodiscard]] constexpr SdoAnswer sdo_answer_of(std::uint8_t first_byte) noexcept {
  return static_cast<SdoAnswer>(first_byte >> 5U);
}
/// Bit 4 of every segment request and answer.
[[nodiscard]] constexpr bool toggle_of(std::uint8_t first_byte) noexcept {
  return (first_byte & 0x10U) != 0;
}
/// The address in bytes 1..3 of an answer or request; nothing where it is shorter, or names no object (0x0000:00).
[[nodiscard]] std::optional<ObjectAddress> address_of(std::span<const std::uint8_t> answer) noexcept;
/// Little-endian; `bytes` holds at least 4.
[[nodiscard]] std::uint32_t decode_u32(std::span<const std::uint8_t> bytes) noexcept;

/// Up to 8 bytes, and zeros behind them.
[[nodiscard]] SdoFrame whole_frame(std::span<const std::uint8_t> bytes) noexcept;

[[nodiscard]] SdoFrame upload_request(ObjectAddress object) noexcept;
/// Of at least one byte; up to four are in the request itself, of more it announces the size.
[[nodiscard]] SdoFrame download_request(ObjectAddress object, std::span<const std::uint8_t> data) noexcept;
[[nodiscard]] SdoFrame upload_segment_request(bool toggle) noexcept;
/// `data` holds at most kSegmentBytes.
[[nodiscard]] SdoFrame download_segment_request(bool toggle, bool last, std::span<const std::uint8_t> data) noexcept;
[[nodiscard]] SdoFrame abort_request(ObjectAddress object, std::uint32_t code) noexcept;

/// What an answer to an upload request says.
struct UploadAnswer {
  bool expedited = false;
  std::optional<std::uint32_t> size;  ///< Bytes of data; nothing where the device does not tell (0x42, 0x40).
};

[[nodiscard]] UploadAnswer decode_upload_answer(std::span<const std::uint8_t> answer) noexcept;

struct UploadSegment {
  bool last = false;
  std::span<const std::uint8_t> data;
};

/// Nothing where the answer is shorter than the data it announces.
[[nodiscard]] std::optional<UploadSegment> decode_upload_segment(std::span<const std::uint8_t> answer) noexcept;

/// CiA 301 §7.2.4.3: every SDO frame has 8 bytes. AC300CAN1 cuts its answers after the last byte that means something
/// (`60 30 20 07`, `4b 21 20 1B DC 00`); SdoSettings::accept_short_answers takes them if all `needed` bytes are there.
[[nodiscard]] bool long_enough(const SdoSettings& settings, std::span<const std::uint8_t> answer,
                               std::size_t needed) noexcept;

/// How many bytes of an expedited answer are data. Without a size bit (0x42) the dictionary decides: `expected`, the
/// bytes of the object's type; 0: not known, then all four.
[[nodiscard]] std::size_t expedited_length(const UploadAnswer& answer, std::size_t expected) noexcept;

/// An answer that confirms a write: 0x60, and with SdoSettings::accept_upload_style_write_answer also 0x43, 0x47, 0x4B
/// or 0x4F (AC300CAN1's F02.02 example).
[[nodiscard]] bool confirms_write(const SdoSettings& settings, std::span<const std::uint8_t> answer) noexcept;

}  // namespace canopen
