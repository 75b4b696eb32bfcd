#include "bridges/mqtt/reasons.h"

#include <mqtt/exception.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>

namespace mqtt {

std::string reason_text(int code) {
  constexpr std::array kOf311 = {"accepted",           "unacceptable protocol version", "identifier rejected",
                                 "server unavailable", "bad user name or password",     "not authorized"};
  std::string name;
  if (is_failure(code)) {
    name = exception::reason_code_str(code);
  } else if (code >= 0 && static_cast<std::size_t>(code) < kOf311.size()) {
    name = kOf311[static_cast<std::size_t>(code)];
  }
  std::array<char, 8> digits{};
  constexpr int kHex = 16;
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), code, kHex).ptr;
  std::string hex(digits.data(), end);
  std::transform(hex.begin(), hex.end(), hex.begin(),
                 [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  return (name.empty() ? "unknown code" : name) + " (0x" + (hex.size() < 2 ? "0" : "") + hex + ")";
}

}  // namespace mqtt
