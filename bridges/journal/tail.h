#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "bridges/journal/files.h"
#include "bridges/journal/line_reader.h"

namespace journal {

/// Hands a file's bytes from `from` on over in pieces.
[[nodiscard]] std::error_code read_pieces(const std::filesystem::path& file, std::uint64_t from,
                                          const std::function<void(std::string_view)>& take);

/// Where a journal goes on.
struct Tail {
  std::uint64_t n = 0;    ///< Of the last line; 0: there is none.
  std::string hash;       ///< Of that line.
  std::uint64_t end = 0;  ///< Bytes of the newest file up to behind its last line.
  bool unended = false;   ///< The newest file does not end in a line break.
  Junk torn{};            ///< What stands behind it in the newest file.
};

/// `files`: all of the directory, in order.
[[nodiscard]] Tail find_tail(const std::filesystem::path& directory, const std::vector<File>& files,
                             std::error_code& failure);

}  // namespace journal
