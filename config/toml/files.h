#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <variant>

namespace config {

struct FileFailure {
  std::string reason;
};

/// What can be told of a file without a look into it.
struct FileFacts {
  std::uintmax_t size = 0;       ///< Bytes.
  bool readable_by_all = false;  ///< Its mode lets everybody on the machine read it.
};

/// A regular file of at most 1 MiB; devices and pipes are refused, they would never end.
[[nodiscard]] std::variant<FileFacts, FileFailure> look_at_file(const std::filesystem::path& path);
/// The whole of such a file.
[[nodiscard]] std::variant<std::string, FileFailure> read_file(const std::filesystem::path& path);
/// Its mode lets the members of that group of this machine read it. `groups`: in the form of group(5).
[[nodiscard]] bool group_may_read(const std::filesystem::path& path, std::string_view group,
                                  const std::filesystem::path& groups = "/etc/group");
/// Surely no such entry. A link is one wherever it leads, and so may be what this user cannot see.
[[nodiscard]] bool is_absent(const std::filesystem::path& path);

}  // namespace config
