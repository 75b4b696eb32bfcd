#pragma once

#include <cstddef>
#include <optional>

#include "config/model.h"

namespace config {

/// Shares of a bus: 1.0 is all that its bitrate carries. A forecast may exceed it.
struct BusLoad {
  double usual = 0;        ///< Motors at rest, usual stuffing: what the gateway will measure.
  double worst = 0;        ///< All that the configuration allows, and every frame with all stuff bits it can have.
  double polls_worst = 0;  ///< The polls' part of `worst`.
  bool at_least = false;   ///< A TPDO comes on change and has no inhibit time: there may be more than both say.
};

/// Forecast of a bus from what the model says; nothing where no bitrate is stated. All drives are taken to be online
/// and operational.
///
/// Counted: TPDOs, heartbeats of the drives and of the gateway, SYNC, and polls (signals read by SDO). A TPDO on change
/// counts with its event timer, at worst with its inhibit time; one of type 0 counts at worst, with every SYNC. RPDOs
/// that are repeated count at worst only: repetition begins with the first command.
/// Not counted, because no period says how often they come: commands, emergencies, what is read and written at boot,
/// SDO reads that stand in for a TPDO that fails to come, PDOs that the gateway leaves alone, other nodes.
///
/// `bus` is a position in model.buses.
[[nodiscard]] std::optional<BusLoad> forecast_load(const Model& model, std::size_t bus);

}  // namespace config
