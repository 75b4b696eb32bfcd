#include "bridges/mqtt/password.h"

#include <algorithm>
#include <fstream>
#include <utility>

namespace mqtt {

std::string read_password(const std::string& path, std::string& password) {
  if (path.empty()) {
    return {};
  }
  std::ifstream file(path);
  std::string line;
  std::getline(file, line);
  line.resize(std::min(line.find('\r'), line.size()));
  if (line.empty()) {
    return "password_file " + path +
           " cannot be read, or begins with an empty line; give it a first line, readable for the gateway's user";
  }
  password = std::move(line);
  return {};
}

}  // namespace mqtt
