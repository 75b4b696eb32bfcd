#include "bridges/journal/repeats.h"

#include <algorithm>
#include <utility>

#include "bridges/text/timestamp.h"

namespace journal {
namespace {

constexpr std::chrono::minutes kPeriod(1);

std::string one_of(const Ended& ended) {
  return "{\"ts\":\"" + text::timestamp(ended.wall) + "\"," + ended.what + '}';
}

}  // namespace

Entry line_of(const Ended& ended) {
  return {ended.wall, ended.at, "\"phase\":\"done\"," + ended.who + ',' + ended.what};
}

std::optional<Entry> Repeats::add(const std::string& kind, Ended ended) {
  const auto [place, is_new] = kinds_.try_emplace(kind, Counted{.until = ended.at + kPeriod});
  if (is_new) {
    return line_of(ended);
  }
  Counted& counted = place->second;
  ++counted.count;
  (counted.first ? counted.last : counted.first) = std::move(ended);
  return std::nullopt;
}

std::vector<Entry> Repeats::take_due(canopen::TimePoint now) {
  std::vector<Entry> lines;
  for (auto kind = kinds_.begin(); kind != kinds_.end();) {
    Counted& counted = kind->second;
    if (counted.until > now) {
      ++kind;
    } else if (counted.count == 0) {
      kind = kinds_.erase(kind);
    } else {
      lines.push_back(line_of_counted(counted));
      counted = Counted{.until = now + kPeriod};
      ++kind;
    }
  }
  return lines;
}

std::vector<Entry> Repeats::take_all() {
  std::vector<Entry> lines;
  for (const auto& [kind, counted] : std::exchange(kinds_, {})) {
    if (counted.count > 0) {
      lines.push_back(line_of_counted(counted));
    }
  }
  return lines;
}

canopen::TimePoint Repeats::due() const noexcept {
  canopen::TimePoint earliest = canopen::kNever;
  for (const auto& [kind, counted] : kinds_) {
    earliest = std::min(earliest, counted.until);
  }
  return earliest;
}

Entry Repeats::line_of_counted(const Counted& counted) {
  const Ended& last = counted.last ? *counted.last : *counted.first;
  if (counted.count == 1) {
    return line_of(last);
  }
  return {last.wall, last.at,
          "\"phase\":\"done\"," + last.who + ",\"count\":" + std::to_string(counted.count) +
              ",\"first\":" + one_of(*counted.first) + ",\"last\":" + one_of(last)};
}

}  // namespace journal
