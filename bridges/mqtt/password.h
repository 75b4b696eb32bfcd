#pragma once

#include <string>

namespace mqtt {

/// Puts the first line of password_file `path` into `password`; without a path nothing. Returns what is wrong with the
/// file, and the remedy; else nothing. To be read at each connection: it may be changed meanwhile.
[[nodiscard]] std::string read_password(const std::string& path, std::string& password);

}  // namespace mqtt
