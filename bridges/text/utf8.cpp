#include "bridges/text/utf8.h"

namespace text {
namespace {

unsigned byte_at(std::string_view text, std::size_t position) {
  return position < text.size() ? static_cast<unsigned char>(text[position]) : 0U;
}

bool continues(unsigned byte) {
  return (byte & 0xC0U) == 0x80U;
}

// Bytes of the character at `position`, 0 where there is none (RFC 3629 §4).
std::size_t character_length(std::string_view text, std::size_t position) {
  const unsigned first = byte_at(text, position);
  const unsigned second = byte_at(text, position + 1);
  if (first < 0x80) {
    return 1;
  }
  if (first < 0xC2 || first > 0xF4 || !continues(second)) {
    return 0;
  }
  if (first < 0xE0) {
    return 2;
  }
  const bool overlong = (first == 0xE0 && second < 0xA0) || (first == 0xF0 && second < 0x90);
  const bool surrogate = first == 0xED && second > 0x9F;
  const bool beyond = first == 0xF4 && second > 0x8F;
  if (overlong || surrogate || beyond || !continues(byte_at(text, position + 2))) {
    return 0;
  }
  if (first < 0xF0) {
    return 3;
  }
  return continues(byte_at(text, position + 3)) ? 4 : 0;
}

}  // namespace

bool is_utf8(std::string_view text) {
  for (std::size_t position = 0; position < text.size();) {
    const std::size_t length = character_length(text, position);
    if (length == 0) {
      return false;
    }
    position += length;
  }
  return true;
}

std::string repaired_utf8(std::string_view text) {
  std::string repaired;
  for (std::size_t position = 0; position < text.size();) {
    const std::size_t length = character_length(text, position);
    if (length == 0) {
      repaired += "\xEF\xBF\xBD";
      ++position;
      continue;
    }
    repaired += text.substr(position, length);
    position += length;
  }
  return repaired;
}

}  // namespace text
