#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "canopen/clock.h"
#include "canopen/survey/burst_meter.h"
#include "canopen/survey/day_extremes.h"
#include "canopen/survey/node_table.h"
#include "canopen/survey/suspicion.h"

namespace canopen {

/// How sound a bus is, of a day (see DayExtremes). Nothing: not known.
struct BusHealth {
  std::optional<Suspicion> suspicion{};
  WallTime suspected_since{};                 ///< Of meaning with a suspicion only.
  std::optional<Extremes> load{};             ///< Per mille of a second.
  std::optional<Extremes> transmit_errors{};  ///< The controller's counters, as they stood each second.
  std::optional<Extremes> receive_errors{};
  std::optional<Extremes> errors{};  ///< Error frames of the last 10 000 frames, as they stood each second.
  std::optional<Burst> burst{};
  std::vector<NodeHealth> nodes{};
};

/// The node with the least of its time-out left; null where none has a margin.
[[nodiscard]] const NodeHealth* worst_node(const BusHealth& health) noexcept;

}  // namespace canopen
