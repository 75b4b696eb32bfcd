#include "bridges/journal/newest_lines.h"

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <string_view>
#include <system_error>
#include <utility>

#include "bridges/journal/files.h"
#include "bridges/journal/line.h"
#include "bridges/journal/tail.h"

namespace journal {
namespace {

// At most as many bytes as are kept.
std::vector<std::string> last_lines_of(const std::filesystem::path& file, std::uint64_t size) {
  std::string bytes;
  const std::uint64_t from = size - std::min<std::uint64_t>(size, NewestLines::kMostBytes);
  if (read_pieces(file, from, [&bytes](std::string_view piece) { bytes += piece; })) {
    return {};
  }
  std::vector<std::string> lines;
  for (std::string_view rest = bytes; !rest.empty();) {
    const std::string_view line = rest.substr(0, rest.find('\n'));
    if (parse_line(line)) {
      lines.emplace_back(line);
    }
    rest.remove_prefix(std::min(line.size() + 1, rest.size()));
  }
  return lines;
}

}  // namespace

void NewestLines::add(std::string line) {
  bytes_ += line.size();
  lines_.push_back(std::move(line));
  while (lines_.size() > kMostLines || bytes_ > kMostBytes) {
    bytes_ -= lines_.front().size();
    lines_.pop_front();
  }
}

std::vector<std::string> read_newest_lines(const std::filesystem::path& directory) {
  std::error_code failure;
  const std::vector<File> files = list_files(directory, failure);
  std::vector<std::string> lines;
  for (auto file = files.rbegin(); file != files.rend() && lines.size() < NewestLines::kMostLines; ++file) {
    std::vector<std::string> older = last_lines_of(directory / to_string(file->name), file->size);
    std::ranges::move(lines, std::back_inserter(older));
    lines = std::move(older);
  }
  return lines;
}

}  // namespace journal
