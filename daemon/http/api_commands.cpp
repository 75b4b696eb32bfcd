#include <algorithm>
#include <charconv>
#include <ranges>
#include <string>

#include "bridges/journal/newest_lines.h"
#include "bridges/text/json_text.h"
#include "daemon/http/respond.h"

namespace gateway::http {
namespace {

constexpr std::size_t kUsualCount = 50;
constexpr std::size_t kMostCount = journal::NewestLines::kMostLines;

std::optional<std::size_t> count_of(const std::string& text) {
  std::size_t count = 0;
  const auto read = std::from_chars(text.data(), text.data() + text.size(), count);
  const bool whole = read.ec == std::errc() && read.ptr == text.data() + text.size();
  return whole && count >= 1 && count <= kMostCount ? std::optional(count) : std::nullopt;
}

}  // namespace

Answer commands(const Site& site, const Target& target) {
  const std::string* const asked = target.find("count");
  const auto count = asked == nullptr ? std::optional(kUsualCount) : count_of(*asked);
  if (!count) {
    return refusal(400, "count=\"" + std::string(beginning(*asked)) + "\": write a number from 1 to " +
                            std::to_string(kMostCount));
  }
  if (!site.journal_lines) {
    return refusal(404, "there is no journal of commands, since [gateway] state_dir is empty");
  }
  const std::deque<std::string>& lines = site.journal_lines();
  Answer answer;
  text::append_list(answer.body, lines | std::views::drop(lines.size() - std::min(lines.size(), *count)),
                    [](std::string& to, const std::string& line) { to += line; });
  return answer;
}

}  // namespace gateway::http
