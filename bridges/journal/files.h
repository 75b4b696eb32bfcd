#pragma once

#include <chrono>
#include <compare>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

namespace journal {

/// `2026-11-26.jsonl`, and when that is full `2026-11-26.2.jsonl`. Their order is that of the chain.
struct FileName {
  std::chrono::sys_days day;
  unsigned part = 1;
  friend auto operator<=>(const FileName&, const FileName&) = default;
};

[[nodiscard]] std::string to_string(const FileName& name);
/// Exactly what to_string() makes.
[[nodiscard]] std::optional<FileName> parse_file_name(std::string_view text);

struct File {
  FileName name;
  std::uint64_t size = 0;  ///< Bytes.
};

/// The files of a journal in the order of the chain; what else stands in the directory is none.
[[nodiscard]] std::vector<File> list_files(const std::filesystem::path& directory, std::error_code& failure);

}  // namespace journal
