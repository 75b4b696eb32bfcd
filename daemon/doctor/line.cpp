#include "daemon/doctor/line.h"

#include <fmt/format.h>

#include <algorithm>

namespace gateway::doctor {
namespace {

const char* name_of(Verdict verdict) noexcept {
  switch (verdict) {
    case Verdict::ok:
      return "ok";
    case Verdict::warning:
      return "warning";
    case Verdict::error:
      break;
  }
  return "error";
}

std::string count_of(const Lines& lines, Verdict verdict) {
  const auto count = std::ranges::count(lines, verdict, &Line::verdict);
  return fmt::format("{} {}{}", count, name_of(verdict), count == 1 ? "" : "s");
}

}  // namespace

std::string to_text(const Lines& lines) {
  std::string text;
  for (const Line& line : lines) {
    text += fmt::format("{:<8} {}: {}\n", name_of(line.verdict), line.subject, line.finding);
    if (!line.remedy.empty()) {
      text += fmt::format("{:<8} -> {}\n", "", line.remedy);
    }
  }
  return text + count_of(lines, Verdict::error) + ", " + count_of(lines, Verdict::warning) + "\n";
}

bool has_error(const Lines& lines) noexcept {
  return std::ranges::any_of(lines, [](const Line& line) { return line.verdict == Verdict::error; });
}

}  // namespace gateway::doctor
