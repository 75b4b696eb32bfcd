#pragma once

#include "canopen/bus/bus_state.h"
#include "canopen/bus/socketcan/interface_query.h"

namespace canopen::socketcan {

/// The bus' state by what the kernel says of its interface. Where the driver does not say all of it, what was known
/// `before` holds: error frames told it.
[[nodiscard]] BusState state_of(const Interface& interface, const BusState& before) noexcept;

}  // namespace canopen::socketcan
