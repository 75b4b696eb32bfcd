#pragma once

#include <string>

#include "bridges/process/plant.h"

namespace gateway::http {

/// The JSON of `B/alarms`: all active alarms, oldest first.
[[nodiscard]] std::string active_alarms_text(const process::Plant& plant);

}  // namespace gateway::http
