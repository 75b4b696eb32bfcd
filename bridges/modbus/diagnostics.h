#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "bridges/modbus/addresses.h"
#include "bridges/process/drive.h"
#include "canopen/clock.h"
#include "config/model.h"

namespace modbus {

using Diagnostics = std::array<std::uint16_t, kDiagnosticsEnd - kDiagnosticsBegin>;

/// All of the block but for 1016, 1020 and the fresh bits, which the unit knows. Ages are as of `now`.
[[nodiscard]] Diagnostics diagnostics_of(const process::Drive& drive, config::WordOrder order, canopen::TimePoint now);

}  // namespace modbus
