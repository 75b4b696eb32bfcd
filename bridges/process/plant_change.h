#pragma once

#include <algorithm>
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "config/model.h"

namespace process {

/// What became of the plant's drives and buses when its configuration changed while it runs: of each position in the
/// new config::Model the position in the old one. Nothing: it is new, or another one under the same name.
struct PlantChange {
  using From = config::Positions;
  From drives;
  From buses;
};

/// What is kept by position, put where it belongs now. `make(position)` gives that of a new one.
template <class Kept, class Make>
[[nodiscard]] std::vector<Kept> realigned(std::vector<Kept> before, const PlantChange::From& from, Make make) {
  std::vector<Kept> now;
  now.reserve(from.size());
  for (std::size_t i = 0; i < from.size(); ++i) {
    if (from[i]) {
      now.push_back(std::move(before[*from[i]]));
    } else {
      now.push_back(make(i));
    }
  }
  return now;
}

/// The positions of before, of `count`, that nothing has kept.
[[nodiscard]] inline std::vector<std::size_t> left_behind(const PlantChange::From& from, std::size_t count) {
  std::vector<std::size_t> left;
  for (std::size_t i = 0; i < count; ++i) {
    if (std::ranges::find(from, std::optional(i)) == from.end()) {
      left.push_back(i);
    }
  }
  return left;
}

}  // namespace process
