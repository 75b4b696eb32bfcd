#pragma once

#include <filesystem>
#include <string>

#include "bridges/disk/descriptor.h"

namespace disk {

/// A directory that no other process uses as long as this lives.
struct OwnDirectory {
  Descriptor lock{};      ///< Of the directory; none: there is a problem.
  std::string problem{};  ///< For people, with the path.
};

/// Takes a directory that is there.
[[nodiscard]] OwnDirectory take_directory(const std::filesystem::path& path);
/// Somebody moved or removed it: what is locked is not what the path names.
[[nodiscard]] bool is_another_directory(const Descriptor& lock, const std::filesystem::path& path);

}  // namespace disk
