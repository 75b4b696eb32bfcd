#pragma once

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

}  // namespace process
