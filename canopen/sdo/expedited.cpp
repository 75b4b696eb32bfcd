#include "canopen/sdo/expedited.h"

#include <algorithm>

namespace canopen {
namespace {

constexpr std::uint8_t kUpload = 0x40;
constexpr std::uint8_t kDownload = 0x20;
constexpr std::uint8_t kAbort = 0x80;
constexpr std::uint8_t kExpedited = 0x02;
constexpr std::uint8_t kSizeGiven = 0x01;

SdoFrame addressed(std::uint8_t command, ObjectAddress object) noexcept {
  return {command, static_cast<std::uint8_t>(object.index & 0xFFU), static_cast<std::uint8_t>(object.index >> 8U),
          object.sub};
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
  return ObjectAddress{static_cast<std::uint16_t>(answer[1] | (answer[2] << 8U)), answer[3]};
}

SdoFrame upload_request(ObjectAddress object) noexcept {
  return addressed(kUpload, object);
}

SdoFrame expedited_download_request(ObjectAddress object, std::span<const std::uint8_t> data) noexcept {
  const std::size_t size = std::min(data.size(), kMaxExpeditedBytes);
  const auto unused = static_cast<std::uint8_t>((kMaxExpeditedBytes - size) << 2U);
  SdoFrame frame = addressed(static_cast<std::uint8_t>(kDownload | kExpedited | kSizeGiven | unused), object);
  std::copy_n(data.begin(), size, frame.begin() + 4);
  return frame;
}

SdoFrame segmented_download_request(ObjectAddress object, std::uint32_t size) noexcept {
  return with_number(addressed(kDownload | kSizeGiven, object), size);
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

std::uint32_t decode_u32(std::span<const std::uint8_t> bytes) noexcept {
  std::uint32_t number = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    number |= std::uint32_t{bytes[i]} << (8 * i);
  }
  return number;
}

}  // namespace canopen
