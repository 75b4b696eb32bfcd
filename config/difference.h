#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "config/model.h"

namespace config {

/// What is different in another model, for a gateway that runs with the first one. Buses and drives are told by their
/// names: their order means nothing.
struct Difference {
  /// Of each position in the new model the position of the very same in the old one; nothing: it is new, or changed.
  using From = std::vector<std::optional<std::size_t>>;

  From drives;  ///< A drive on a bus that changed did so, too: its heartbeats and its load are the bus's.
  From buses;
  std::vector<std::string> gateway;  ///< Keys of [gateway] with another value.
  bool modbus = false;               ///< The section is another one, came or went; likewise the following.
  bool mqtt = false;
  bool http = false;
  bool recorder = false;
};

[[nodiscard]] Difference difference(const Model& before, const Model& now);

/// Nothing a gateway would do otherwise; the order of drives and buses may be another.
[[nodiscard]] bool is_none(const Difference& difference, const Model& before);

/// The position of the one with this name.
template <class Named>
[[nodiscard]] std::optional<std::size_t> find_named(const std::vector<Named>& all, const std::string& name) {
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (all[i].name == name) {
      return i;
    }
  }
  return std::nullopt;
}

}  // namespace config
