#include "canopen/sdo/segmented.h"

#include <algorithm>

namespace canopen {
namespace {

constexpr std::uint8_t kUploadSegment = 0x60;
constexpr std::uint8_t kDownloadSegment = 0x00;
constexpr std::uint8_t kToggle = 0x10;
constexpr std::uint8_t kLast = 0x01;

}  // namespace

SdoFrame upload_segment_request(bool toggle) noexcept {
  return {static_cast<std::uint8_t>(kUploadSegment | (toggle ? kToggle : 0U))};
}

SdoFrame download_segment_request(bool toggle, bool last, std::span<const std::uint8_t> data) noexcept {
  const std::size_t size = std::min(data.size(), kSegmentBytes);
  const auto unused = static_cast<std::uint8_t>((kSegmentBytes - size) << 1U);
  SdoFrame frame{static_cast<std::uint8_t>(kDownloadSegment | (toggle ? kToggle : 0U) | unused | (last ? kLast : 0U))};
  std::copy_n(data.begin(), size, frame.begin() + 1);
  return frame;
}

std::optional<UploadSegment> decode_upload_segment(std::span<const std::uint8_t> answer) noexcept {
  if (answer.empty()) {
    return std::nullopt;
  }
  const std::size_t size = kSegmentBytes - ((answer[0] >> 1U) & 0x07U);
  if (answer.size() < 1 + size) {
    return std::nullopt;
  }
  return UploadSegment{(answer[0] & kLast) != 0, answer.subspan(1, size)};
}

}  // namespace canopen
