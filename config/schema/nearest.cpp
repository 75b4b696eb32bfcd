#include "config/schema/nearest.h"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <vector>

#include "config/schema/complaint.h"

namespace config {
namespace {

// Longer names are no typing mistake of ours; the measure is quadratic.
constexpr std::size_t kLongest = 64;

/// Optimal string alignment distance.
std::size_t distance(std::string_view a, std::string_view b) {
  a = a.substr(0, kLongest);
  b = b.substr(0, kLongest);
  std::vector<std::size_t> before(b.size() + 1);
  std::vector<std::size_t> last(b.size() + 1);
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) {
    last[j] = j;
  }
  for (std::size_t i = 1; i <= a.size(); ++i) {
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replace = last[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, replace});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) {
        row[j] = std::min(row[j], before[j - 2] + 1);
      }
    }
    before.swap(last);
    last.swap(row);
  }
  return last[b.size()];
}

/// One begins with the other: `maximum` for `max`.
bool begins(std::string_view name, std::string_view candidate) {
  constexpr std::size_t kShortest = 3;
  return std::min(name.size(), candidate.size()) >= kShortest &&
         (name.starts_with(candidate) || candidate.starts_with(name));
}

/// Few mistakes for its length.
bool is_near(std::string_view name, std::string_view candidate, std::size_t mistakes) {
  return 2 * mistakes <= std::min(std::max(name.size(), candidate.size()), kLongest);
}

}  // namespace

std::string_view nearest(std::string_view name, std::span<const std::string_view> candidates) {
  std::string_view best;
  std::size_t least = std::numeric_limits<std::size_t>::max();
  for (const std::string_view candidate : candidates) {
    const bool longer = begins(name, candidate);
    // What is left out at the end is no typing mistake for each of its letters: `password` is `password_file`.
    const std::size_t mistakes = distance(name, candidate) / (longer ? 2 : 1);
    if (mistakes < least && (longer || is_near(name, candidate, mistakes))) {
      least = mistakes;
      best = candidate;
    }
  }
  return best;
}

std::string nearest_or_all(std::string_view name, std::span<const std::string_view> candidates) {
  if (const auto near = nearest(name, candidates); !near.empty()) {
    return "nearest is " + in_quotes(near);
  }
  std::string all;
  for (const std::string_view candidate : candidates) {
    all += (all.empty() ? "there are " : ", ") + std::string(candidate);
  }
  return all.empty() ? "there are none" : all;
}

}  // namespace config
