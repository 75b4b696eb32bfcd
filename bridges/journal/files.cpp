#include "bridges/journal/files.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdio>

namespace journal {
namespace {

constexpr std::string_view kEnding = ".jsonl";

// Exactly `digits` of them.
std::optional<unsigned> number_at(std::string_view text, std::size_t at, std::size_t digits) {
  const std::string_view part = text.substr(at, digits);
  unsigned number = 0;
  const auto end = std::from_chars(part.data(), part.data() + part.size(), number);
  if (part.size() != digits || end.ec != std::errc{} || end.ptr != part.data() + part.size()) {
    return std::nullopt;
  }
  return number;
}

}  // namespace

std::string to_string(const FileName& name) {
  const std::chrono::year_month_day date(name.day);
  std::array<char, 32> text{};
  const int size = std::snprintf(text.data(), text.size(), "%04d-%02u-%02u", static_cast<int>(date.year()),
                                 static_cast<unsigned>(date.month()), static_cast<unsigned>(date.day()));
  std::string whole(text.data(), static_cast<std::size_t>(size));
  if (name.part > 1) {
    whole += '.' + std::to_string(name.part);
  }
  return whole += kEnding;
}

std::optional<FileName> parse_file_name(std::string_view text) {
  constexpr std::size_t kDate = 10;
  const auto of_year = number_at(text, 0, 4);
  const auto of_month = text.size() > kDate ? number_at(text, 5, 2) : std::nullopt;
  const auto of_day = text.size() > kDate ? number_at(text, 8, 2) : std::nullopt;
  if (!of_year || !of_month || !of_day) {
    return std::nullopt;
  }
  const std::chrono::year_month_day date(std::chrono::year(static_cast<int>(*of_year)), std::chrono::month(*of_month),
                                         std::chrono::day(*of_day));
  if (!date.ok()) {
    return std::nullopt;
  }
  FileName name{std::chrono::sys_days(date), 1};
  std::string_view rest = text.substr(kDate);
  if (rest.starts_with('.') && rest != kEnding && rest.ends_with(kEnding)) {
    rest.remove_suffix(kEnding.size());
    name.part = number_at(rest, 1, rest.size() - 1).value_or(0);
  }
  return name.part > 0 && to_string(name) == text ? std::optional(name) : std::nullopt;
}

std::vector<File> list_files(const std::filesystem::path& directory, std::error_code& failure) {
  std::vector<File> files;
  std::filesystem::directory_iterator entries(directory, failure);
  for (const auto end = std::filesystem::directory_iterator(); !failure && entries != end; entries.increment(failure)) {
    const auto name = parse_file_name(entries->path().filename().string());
    std::error_code gone;
    if (name && entries->is_regular_file(gone)) {
      const std::uintmax_t size = entries->file_size(gone);
      files.push_back({*name, gone ? 0 : size});
    }
  }
  std::sort(files.begin(), files.end(), [](const File& left, const File& right) { return left.name < right.name; });
  return files;
}

}  // namespace journal
