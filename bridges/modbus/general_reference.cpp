#include "bridges/modbus/general_reference.h"

#include <algorithm>
#include <cstddef>

#include "bridges/modbus/mbap.h"
#include "bridges/modbus/request.h"

namespace modbus {
namespace {

// Of request and answer: function, MEI type, two bytes of protocol options, node, index, sub-index, start, count.
constexpr std::size_t kControl = 2;
constexpr std::size_t kReserved = 3;
constexpr std::size_t kNode = 4;
constexpr std::size_t kIndex = 5;
constexpr std::size_t kSub = 7;
constexpr std::size_t kStart = 8;
constexpr std::size_t kCount = 10;
constexpr std::size_t kReferenceHead = 12;
constexpr std::size_t kMaxData = kMaxPdu - kReferenceHead;
constexpr std::uint8_t kWrite = 0x01;

// The head of the request, the count of what follows, and that.
std::vector<std::uint8_t> answer_to(std::span<const std::uint8_t> pdu, std::span<const std::uint8_t> data) {
  std::vector<std::uint8_t> answer(kReferenceHead + data.size());
  std::ranges::copy(pdu.first(kReferenceHead), answer.begin());
  answer[kCount] = static_cast<std::uint8_t>(data.size() >> 8);
  answer[kCount + 1] = static_cast<std::uint8_t>(data.size());
  std::ranges::copy(data, answer.begin() + kReferenceHead);
  return answer;
}

}  // namespace

std::variant<Reference, Exception> parse_reference(std::span<const std::uint8_t> pdu) noexcept {
  if (pdu.size() < kReferenceHead || (pdu[kControl] & ~kWrite) != 0 || pdu[kReserved] != 0) {
    return Exception::illegal_value;
  }
  const Reference reference{.write = pdu[kControl] == kWrite,
                            .node = pdu[kNode],
                            .object = {.index = word_at(pdu, kIndex), .sub = pdu[kSub]},
                            .start = word_at(pdu, kStart),
                            .count = word_at(pdu, kCount),
                            .data = pdu.subspan(kReferenceHead)};
  // A write is of the object whole: SDO knows no part of one.
  const bool right = reference.write
                         ? reference.start == 0 && reference.count == reference.data.size() && !reference.data.empty()
                         : reference.data.empty();
  return right ? std::variant<Reference, Exception>(reference) : Exception::illegal_value;
}

std::vector<std::uint8_t> bytes_read(std::span<const std::uint8_t> pdu, const Reference& reference,
                                     std::span<const std::uint8_t> bytes) {
  const std::size_t from = std::min<std::size_t>(reference.start, bytes.size());
  const std::size_t wanted = reference.count == 0 ? kMaxData : std::min<std::size_t>(reference.count, kMaxData);
  return answer_to(pdu, bytes.subspan(from, std::min(wanted, bytes.size() - from)));
}

std::vector<std::uint8_t> written(std::span<const std::uint8_t> pdu) {
  return answer_to(pdu, {});
}

std::vector<std::uint8_t> aborted(std::uint32_t code) {
  // An extended exception: six bytes follow, the MEI type, the mark of an abort, its code.
  return {static_cast<std::uint8_t>(Function::encapsulated_interface) | 0x80,
          0xFF,
          0x00,
          0x06,
          static_cast<std::uint8_t>(Encapsulated::canopen),
          0xEC,
          static_cast<std::uint8_t>(code >> 24),
          static_cast<std::uint8_t>(code >> 16),
          static_cast<std::uint8_t>(code >> 8),
          static_cast<std::uint8_t>(code)};
}

}  // namespace modbus
