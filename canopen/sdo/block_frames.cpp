#include "canopen/sdo/block_frames.h"

#include <algorithm>

namespace canopen {
namespace {

constexpr unsigned kBlockUpload = 0xA0;
constexpr unsigned kBlockDownload = 0xC0;
constexpr unsigned kWithCrc = 0x04;
constexpr unsigned kWithSize = 0x02;
// Bits 1..0 of what the client sends.
constexpr unsigned kEnd = 1;
constexpr unsigned kAcknowledge = 2;
constexpr unsigned kStart = 3;
constexpr unsigned kLastSegment = 0x80;

SdoFrame first_byte(unsigned byte) noexcept {
  return {static_cast<std::uint8_t>(byte)};
}

SdoFrame named(unsigned command, ObjectAddress object) noexcept {
  return {static_cast<std::uint8_t>(command), static_cast<std::uint8_t>(object.index & 0xFFU),
          static_cast<std::uint8_t>(object.index >> 8U), object.sub};
}

}  // namespace

SdoFrame block_download_request(ObjectAddress object, std::uint32_t size) noexcept {
  SdoFrame frame = named(kBlockDownload | kWithCrc | kWithSize, object);
  for (std::size_t i = 0; i < 4; ++i) {
    frame[4 + i] = static_cast<std::uint8_t>(size >> (8 * i));
  }
  return frame;
}

SdoFrame block_upload_request(ObjectAddress object, std::uint8_t most_segments, std::uint8_t switch_size) noexcept {
  SdoFrame frame = named(kBlockUpload | kWithCrc, object);
  frame[4] = most_segments;
  frame[5] = switch_size;
  return frame;
}

SdoFrame block_upload_start() noexcept {
  return first_byte(kBlockUpload | kStart);
}

SdoFrame block_segment(std::uint8_t number, bool last, std::span<const std::uint8_t> data) noexcept {
  SdoFrame frame = first_byte(number | (last ? kLastSegment : 0U));
  std::copy_n(data.begin(), std::min(data.size(), kSegmentBytes), frame.begin() + 1);
  return frame;
}

SdoFrame block_upload_acknowledge(std::uint8_t number, std::uint8_t most_segments) noexcept {
  SdoFrame frame = first_byte(kBlockUpload | kAcknowledge);
  frame[1] = number;
  frame[2] = most_segments;
  return frame;
}

SdoFrame block_download_end(std::size_t unused, std::uint16_t crc) noexcept {
  SdoFrame frame = first_byte(kBlockDownload | static_cast<unsigned>(unused << 2U) | kEnd);
  frame[1] = static_cast<std::uint8_t>(crc & 0xFFU);
  frame[2] = static_cast<std::uint8_t>(crc >> 8U);
  return frame;
}

SdoFrame block_upload_end() noexcept {
  return first_byte(kBlockUpload | kEnd);
}

BlockSegment decode_block_segment(std::span<const std::uint8_t> frame) noexcept {
  return {static_cast<std::uint8_t>(frame[0] & ~kLastSegment), (frame[0] & kLastSegment) != 0,
          frame.subspan(1, kSegmentBytes)};
}

BlockUploadEnd decode_block_upload_end(std::span<const std::uint8_t> frame) noexcept {
  return {(frame[0] >> 2U) & 0x07U, static_cast<std::uint16_t>(frame[1] | (frame[2] << 8U))};
}

}  // namespace canopen
