#include "canopen/survey/error_counts.h"

#include <linux/can/error.h>

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

namespace canopen {
namespace {

constexpr std::size_t kProtocolError = 2;
constexpr std::size_t kProtocolPlace = 3;

// What a controller that tells no kind was about: m_can, c_can and sja1000 tell a missing acknowledgement, and some of
// them a wrong CRC, by the place alone.
ErrorCounts by_place(unsigned place) noexcept {
  ErrorCounts counts;
  counts.ack = place == CAN_ERR_PROT_LOC_ACK ? 1 : 0;
  counts.crc = place == CAN_ERR_PROT_LOC_CRC_SEQ || place == CAN_ERR_PROT_LOC_CRC_DEL ? 1 : 0;
  return counts;
}

}  // namespace

ErrorCounts& ErrorCounts::operator+=(const ErrorCounts& other) noexcept {
  bit += other.bit;
  stuff += other.stuff;
  form += other.form;
  crc += other.crc;
  ack += other.ack;
  wire += other.wire;
  return *this;
}

ErrorCounts error_counts_of(const Frame& error) noexcept {
  ErrorCounts counts;
  if ((error.id & CAN_ERR_PROT) != 0) {
    constexpr unsigned kAnyBit = CAN_ERR_PROT_BIT | CAN_ERR_PROT_BIT0 | CAN_ERR_PROT_BIT1;
    const unsigned kind = error.data[kProtocolError];
    const unsigned place = error.data[kProtocolPlace];
    counts = (kind & (kAnyBit | CAN_ERR_PROT_STUFF | CAN_ERR_PROT_FORM)) == 0 ? by_place(place) : ErrorCounts{};
    // slcan tells of a wrong CRC as of a bit error in the CRC.
    const bool crc = (kind & kAnyBit) == CAN_ERR_PROT_BIT && place == CAN_ERR_PROT_LOC_CRC_SEQ;
    counts.crc |= crc ? 1U : 0U;
    counts.bit = (kind & kAnyBit) != 0 && !crc ? 1 : 0;
    counts.stuff = (kind & CAN_ERR_PROT_STUFF) != 0 ? 1 : 0;
    counts.form = (kind & CAN_ERR_PROT_FORM) != 0 ? 1 : 0;
  }
  if ((error.id & CAN_ERR_ACK) != 0) {
    counts.ack = 1;
  }
  counts.wire = counts.bit + counts.stuff + counts.form + counts.crc > 0 ? 1 : 0;
  return counts;
}

std::string text_of(const ErrorCounts& counts) {
  std::array<std::pair<std::uint32_t, std::string_view>, 5> kinds{{{counts.bit, "bit"},
                                                                   {counts.stuff, "stuff"},
                                                                   {counts.form, "form"},
                                                                   {counts.crc, "CRC"},
                                                                   {counts.ack, "no acknowledgement"}}};
  std::ranges::sort(kinds, [](const auto& one, const auto& other) {
    return one.first != other.first ? one.first > other.first : one.second < other.second;
  });
  std::string text;
  for (const auto& [count, name] : kinds) {
    if (count > 0) {
      text.append(text.empty() ? "" : ", ").append(std::to_string(count)).append(" ").append(name);
    }
  }
  return text;
}

}  // namespace canopen
