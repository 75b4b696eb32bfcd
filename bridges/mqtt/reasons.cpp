#include "bridges/mqtt/reasons.h"

#include <mqtt/exception.h>

#include <array>
#include <cstdio>

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
  std::array<char, 16> hex{};
  std::snprintf(hex.data(), hex.size(), " (0x%02X)", static_cast<unsigned>(code));
  return (name.empty() ? "unknown code" : name) + hex.data();
}

std::string without_paths(std::string text, const std::vector<std::string>& paths) {
  for (const std::string& path : paths) {
    const std::string shown = " " + path;
    for (auto at = path.empty() ? std::string::npos : text.find(shown); at != std::string::npos;
         at = text.find(shown)) {
      text.erase(at, shown.size());
    }
  }
  return text;
}

}  // namespace mqtt
