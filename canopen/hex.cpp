#include "canopen/hex.h"

#include <string_view>

namespace canopen {

std::string hex(std::uint64_t value, unsigned digits) {
  constexpr std::string_view kDigits = "0123456789ABCDEF";
  std::string text;
  for (unsigned shift = 60;; shift -= 4) {
    const bool wanted = shift / 4 < digits || (value >> shift) != 0;
    if (wanted || shift == 0) {
      text += kDigits[(value >> shift) & 0xF];
    }
    if (shift == 0) {
      return text;
    }
  }
}

}  // namespace canopen
