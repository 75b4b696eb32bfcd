#include "tests/support/block_codec.h"

#include <algorithm>

namespace support::block {

canopen::ObjectAddress multiplexer(const Content& content) noexcept {
  return {get_u16(content, 1), content[3]};
}

std::uint16_t get_u16(const Content& content, std::size_t at) noexcept {
  return static_cast<std::uint16_t>(content[at] | unsigned{content[at + 1]} << 8U);
}

std::uint32_t get_u32(const Content& content, std::size_t at) noexcept {
  return get_u16(content, at) | static_cast<std::uint32_t>(get_u16(content, at + 2)) << 16U;
}

bool zero_from(const Content& content, std::size_t first) noexcept {
  return std::ranges::all_of(std::span(content).subspan(first), [](std::uint8_t byte) { return byte == 0; });
}

Content command(unsigned byte) noexcept {
  return {static_cast<std::uint8_t>(byte)};
}

Content command(unsigned byte, canopen::ObjectAddress object) noexcept {
  Content content = command(byte);
  put_u16(content, 1, object.index);
  content[3] = object.sub;
  return content;
}

void put_u16(Content& content, std::size_t at, std::uint16_t value) noexcept {
  content[at] = static_cast<std::uint8_t>(value & 0xFFU);
  content[at + 1] = static_cast<std::uint8_t>(value >> 8U);
}

void put_u32(Content& content, std::size_t at, std::uint32_t value) noexcept {
  put_u16(content, at, static_cast<std::uint16_t>(value & 0xFFFFU));
  put_u16(content, at + 2, static_cast<std::uint16_t>(value >> 16U));
}

Content abort_transfer(const Abort& abort) noexcept {
  Content content = command(kAbortCommand, abort.object);
  put_u32(content, 4, abort.code);
  return content;
}

std::size_t put_segment(Content& content, std::span<const std::uint8_t> data, std::size_t offset) noexcept {
  const auto part = data.subspan(offset, std::min(kSegmentBytes, data.size() - offset));
  std::ranges::copy(part, content.begin() + 1);
  return part.size();
}

std::uint16_t crc16(std::span<const std::uint8_t> data) noexcept {
  unsigned crc = 0;
  for (const std::uint8_t byte : data) {
    crc ^= static_cast<unsigned>(byte) << 8U;
    for (int bit = 0; bit < 8; ++bit) {
      crc = (crc & 0x8000U) != 0 ? (crc << 1U) ^ 0x1021U : crc << 1U;
    }
    crc &= 0xFFFFU;
  }
  return static_cast<std::uint16_t>(crc);
}

}  // namespace support::block
