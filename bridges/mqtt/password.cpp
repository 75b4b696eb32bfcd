#include "bridges/mqtt/password.h"

#include <algorithm>
#include <fstream>
#include <utility>

namespace mqtt {

std::optional<std::string> password_of(const std::string& path) {
  std::ifstream file(path);
  std::string line;
  std::getline(file, line);
  line.resize(std::min(line.find('\r'), line.size()));
  return line.empty() ? std::nullopt : std::optional(std::move(line));
}

}  // namespace mqtt
