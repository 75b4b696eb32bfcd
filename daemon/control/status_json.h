#pragma once

#include <string>

#include "bridges/process/plant.h"
#include "canopen/clock.h"

namespace gateway::control {

/// What `status` tells, as one JSON object: the gateway, its buses, its drives with their values, what was commanded,
/// and the alarms that are active. Numbers in engineering units, times in seconds, loads in percent.
[[nodiscard]] std::string status_json(const process::Plant& plant, canopen::TimePoint started, canopen::TimePoint now);

}  // namespace gateway::control
