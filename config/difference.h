#pragma once

#include <string>
#include <vector>

#include "config/model.h"

namespace config {

/// What is different in another model, for a gateway that runs with the first one. Buses and drives are told by their
/// names: their order means nothing.
struct Difference {
  Positions drives;  ///< A drive on a bus that changed did so, too: its heartbeats and its load are the bus's.
  Positions buses;
  std::vector<std::string> gateway;  ///< Keys of [gateway] with another value.
  bool modbus = false;               ///< The section is another one, came or went; likewise the following.
  bool mqtt = false;
  bool http = false;
  bool recorder = false;
};

[[nodiscard]] Difference difference(const Model& before, const Model& now);

/// Nothing a gateway would do otherwise; the order of drives and buses may be another.
[[nodiscard]] bool is_none(const Difference& difference, const Model& before);

}  // namespace config
