#pragma once

#include <string>

#include "bridges/process/health.h"
#include "canopen/clock.h"

namespace gateway {

/// What this process knows of itself. `journal`: its newest hash, empty where there is none.
[[nodiscard]] process::ProgramHealth program_health(canopen::TimePoint started, std::string journal);

/// Nobody set the time of day yet: the machine has no clock that runs on while it is off.
[[nodiscard]] bool is_unset(canopen::WallTime now) noexcept;

}  // namespace gateway
