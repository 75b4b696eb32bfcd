#pragma once

#include <cstdint>
#include <optional>
#include <string>
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
  WallTime suspected_since{};                 ///< Of meaning with a suspicion only, as the next one.
  Duration suspicion_age{};                   ///< Since the newest look that showed it; what it says is of then.
  std::optional<Extremes> load{};             ///< Per mille of a second.
  std::optional<Extremes> transmit_errors{};  ///< The controller's counters, as they stood each second.
  std::optional<Extremes> receive_errors{};
  std::optional<Extremes> errors{};  ///< Error frames of the last 10 000 frames, as they stood each second.
  std::optional<Burst> burst{};
  std::vector<NodeHealth> nodes{};
};

/// The suspicion as sentences, with its age where its signs are gone by now; empty where there is none.
[[nodiscard]] std::string suspicion_text(const BusHealth& health);

/// The node with the least of its time-out left; null where none has a margin.
[[nodiscard]] const NodeHealth* worst_node(const BusHealth& health) noexcept;

}  // namespace canopen
