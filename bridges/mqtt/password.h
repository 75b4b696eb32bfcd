#pragma once

#include <optional>
#include <string>

namespace mqtt {

/// The first line of a file; nothing: it cannot be read, or begins with an empty line.
[[nodiscard]] std::optional<std::string> password_of(const std::string& path);

}  // namespace mqtt
