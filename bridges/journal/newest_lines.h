#pragma once

#include <cstddef>
#include <deque>
#include <filesystem>
#include <string>
#include <vector>

namespace journal {

/// The newest lines of a journal, without their line breaks, oldest first: to be shown without asking a disk.
class NewestLines {
 public:
  static constexpr std::size_t kMostLines = 200;
  static constexpr std::size_t kMostBytes = 1024UL * 1024;

  void add(std::string line);
  [[nodiscard]] const std::deque<std::string>& lines() const noexcept { return lines_; }

 private:
  std::deque<std::string> lines_;
  std::size_t bytes_ = 0;
};

/// Reads them from the files; what cannot be read, or is no line, is left out.
[[nodiscard]] std::vector<std::string> read_newest_lines(const std::filesystem::path& directory);

}  // namespace journal
