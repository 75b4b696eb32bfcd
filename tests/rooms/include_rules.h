#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace rooms {

/// What is wrong with one #include.
struct Violation {
  std::string file;  ///< Relative to the project's root.
  int line = 0;
  std::string included;
  std::string reason;

  friend bool operator==(const Violation&, const Violation&) = default;
};

/// `canopen/bus/bus.cpp:3: "config/model.h": …`
[[nodiscard]] std::string to_string(const Violation& violation);

/// The folders the rules know, each a room.
[[nodiscard]] std::vector<std::string> room_names();

/// Reads every #include of `text`, the content of `file`. Names that begin with no room are not the project's and pass
/// in angle brackets only.
[[nodiscard]] std::vector<Violation> check_text(std::string_view file, std::string_view text);

/// Every .h and .cpp of the rooms below `root`; `files_read` counts them.
[[nodiscard]] std::vector<Violation> check_tree(const std::filesystem::path& root, std::size_t& files_read);

}  // namespace rooms
