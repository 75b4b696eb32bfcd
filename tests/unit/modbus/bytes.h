#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace modbus_test {

using Bytes = std::vector<std::uint8_t>;

/// `"03 0000 000d"`: hexadecimal digits in pairs, blanks as one likes.
inline Bytes hex(std::string_view text) {
  std::string digits;
  for (const char character : text) {
    if (character != ' ') {
      digits.push_back(character);
    }
  }
  if (digits.size() % 2 != 0) {
    throw std::invalid_argument("an odd number of digits: " + digits);
  }
  Bytes bytes;
  for (std::size_t i = 0; i < digits.size(); i += 2) {
    bytes.push_back(static_cast<std::uint8_t>(std::stoul(digits.substr(i, 2), nullptr, 16)));
  }
  return bytes;
}

/// A whole frame around a PDU.
inline Bytes frame(std::uint8_t unit, std::string_view pdu, std::uint16_t transaction = 1) {
  const Bytes body = hex(pdu);
  const std::size_t length = body.size() + 1;
  // In one piece: of a vector that grows g++ 12 believes, when it inlines, that it may write behind the first seven.
  const std::array<std::uint8_t, 7> header{
      static_cast<std::uint8_t>(transaction >> 8), static_cast<std::uint8_t>(transaction), 0,   0,
      static_cast<std::uint8_t>(length >> 8),      static_cast<std::uint8_t>(length),      unit};
  Bytes bytes(header.size() + body.size());
  std::copy(body.begin(), body.end(), std::copy(header.begin(), header.end(), bytes.begin()));
  return bytes;
}

}  // namespace modbus_test
