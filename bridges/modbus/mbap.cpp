#include "bridges/modbus/mbap.h"

#include <algorithm>

namespace modbus {
namespace {

constexpr std::size_t kProtocolHigh = 2;
constexpr std::size_t kProtocolLow = 3;
constexpr std::size_t kLengthHigh = 4;
constexpr std::size_t kLengthLow = 5;
constexpr std::size_t kUnit = 6;
constexpr std::size_t kBeforeLengthCounts = 6;

}  // namespace

FoundFrame find_frame(std::span<const std::uint8_t> bytes) noexcept {
  constexpr FoundFrame kBroken{.framing = Framing::broken, .size = 0};
  if ((bytes.size() > kProtocolHigh && bytes[kProtocolHigh] != 0) ||
      (bytes.size() > kProtocolLow && bytes[kProtocolLow] != 0)) {
    return kBroken;
  }
  if (bytes.size() <= kLengthLow) {
    return {};
  }
  // Counts the unit id and the PDU, which has at least its function code.
  const std::size_t length = word_at(bytes, kLengthHigh);
  if (length < 2 || length > 1 + kMaxPdu) {
    return kBroken;
  }
  const std::size_t size = kBeforeLengthCounts + length;
  if (bytes.size() < size) {
    return {};
  }
  return {.framing = Framing::complete, .size = size};
}

std::span<const std::uint8_t> frame_answer(std::span<const std::uint8_t> frame, std::span<const std::uint8_t> pdu,
                                           std::span<std::uint8_t, kMaxFrame> out) noexcept {
  std::ranges::copy(frame.first<kHeaderSize>(), out.begin());
  const std::size_t length = pdu.size() + 1;
  out[kLengthHigh] = static_cast<std::uint8_t>(length >> 8);
  out[kLengthLow] = static_cast<std::uint8_t>(length);
  std::ranges::copy(pdu, out.begin() + kHeaderSize);
  return out.first(kHeaderSize + pdu.size());
}

std::uint8_t unit_of(std::span<const std::uint8_t> frame) noexcept {
  return frame[kUnit];
}

std::span<const std::uint8_t> pdu_of(std::span<const std::uint8_t> frame) noexcept {
  return frame.subspan(kHeaderSize);
}

}  // namespace modbus
