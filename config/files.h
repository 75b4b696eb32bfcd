#pragma once

#include <filesystem>
#include <string>
#include <variant>

namespace config {

struct FileFailure {
  std::string reason;
};

/// The whole of a regular file of at most 1 MiB; devices and pipes are refused, they would never end.
[[nodiscard]] std::variant<std::string, FileFailure> read_file(const std::filesystem::path& path);

}  // namespace config
