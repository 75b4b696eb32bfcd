#include "canopen/sdo/frames.h"

#include <algorithm>

namespace canopen {
namespace {

// Command specifiers of the client, and the bits beside them.
constexpr std::uint8_t kDownloadSegment = 0x00;
constexpr std::uint8_t kDownload = 0x20;
constexpr std::uint8_t kUpload = 0x40;
constexpr std::uint8_t kUploadSegment = 0x60;
constexpr std::uint8_t kAbort = 0x80;
constexpr std::uint8_t kExpedited = 0x02;
constexpr std::uint8_t kSizeGiven = 0x01;
constexpr std::uint8_t kToggle = 0x10;
constexpr std::uint8_t kLast = 0x01;

SdoFrame addressed(unsigned command, ObjectAddress object) noexcept {
  return {static_cast<std::uint8_t>(command), static_cast<std::uint8_t>(object.index & 0xFFU),
          static_cast<std::uint8_t>(object.index >> 8U), object.sub};
}

SdoFrame with_number(SdoFrame frame, std::uint32_t number) noexcept {
  for (std::size_t i = 0; i < 4; ++i) {
    frame[4 + i] = static_cast<std::uint8_t>(number >> (8 * i));
  }
  return frame;
}

}  // namespace

std::optional<ObjectAddress> address_of(std::span<const std::uint8_t> answer) noexcept {
  if (answer.size() < 4) {
    return std::nullopt;
  }
  const ObjectAddress address{static_cast<std::uint16_t>(answer[1] | (answer[2] << 8U)), answer[3]};
  return address == ObjectAddress{} ? std::nullopt : std::optional(address);
}

std::uint32_t decode_u32(std::span<const std::uint8_t> bytes) noexcept {
  std::uint32_t number = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    number |= std::uint32_t{bytes[i]} << (8 * i);
  }
  return number;
}

SdoFrame whole_frame(std::span<const std::uint8_t> bytes) noexcept {
  SdoFrame frame{};
  std::copy_n(bytes.begin(), std::min(bytes.size(), frame.size()), frame.begin());
  return frame;
}

SdoFrame upload_request(ObjectAddress object) noexcept {
  return addressed(kUpload, object);
}

SdoFrame download_request(ObjectAddress object, std::span<const std::uint8_t> data) noexcept {
  if (data.size() > kMaxExpeditedBytes) {
    return with_number(addressed(kDownload | kSizeGiven, object), static_cast<std::uint32_t>(data.size()));
  }
  const auto unused = static_cast<unsigned>(kMaxExpeditedBytes - data.size()) << 2U;
  SdoFrame frame = addressed(kDownload | kExpedited | kSizeGiven | unused, object);
  std::copy(data.begin(), data.end(), frame.begin() + 4);
  return frame;
}

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

SdoFrame abort_request(ObjectAddress object, std::uint32_t code) noexcept {
  return with_number(addressed(kAbort, object), code);
}

UploadAnswer decode_upload_answer(std::span<const std::uint8_t> answer) noexcept {
  UploadAnswer decoded;
  decoded.expedited = (answer[0] & kExpedited) != 0;
  if ((answer[0] & kSizeGiven) == 0) {
    return decoded;
  }
  if (decoded.expedited) {
    decoded.size = kMaxExpeditedBytes - ((answer[0] >> 2U) & 0x03U);
  } else if (answer.size() >= 8) {
    decoded.size = decode_u32(answer.subspan(4));
  }
  return decoded;
}

std::optional<UploadSegment> decode_upload_segment(std::span<const std::uint8_t> answer) noexcept {
  const std::size_t size = kSegmentBytes - ((answer[0] >> 1U) & 0x07U);
  if (answer.size() < 1 + size) {
    return std::nullopt;
  }
  return UploadSegment{(answer[0] & kLast) != 0, answer.subspan(1, size)};
}

bool long_enough(const SdoSettings& settings, std::span<const std::uint8_t> answer, std::size_t needed) noexcept {
  return answer.size() >= 8 || (settings.accept_short_answers && answer.size() >= needed);
}

std::size_t expedited_length(const UploadAnswer& answer, std::size_t expected) noexcept {
  if (answer.size) {
    return *answer.size;
  }
  return expected == 0 || expected > kMaxExpeditedBytes ? kMaxExpeditedBytes : expected;
}

bool confirms_write(const SdoSettings& settings, std::span<const std::uint8_t> answer) noexcept {
  const SdoAnswer kind = sdo_answer_of(answer[0]);
  return kind == SdoAnswer::download || (kind == SdoAnswer::upload && settings.accept_upload_style_write_answer &&
                                         decode_upload_answer(answer).expedited);
}

}  // namespace canopen
