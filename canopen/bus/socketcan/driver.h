#pragma once

#include <string>
#include <string_view>

#include "canopen/bus/echo.h"

namespace canopen::socketcan {

/// Name of the driver behind a network interface (ETHTOOL_GDRVINFO), asked through any socket; empty where the kernel
/// names none.
[[nodiscard]] std::string driver_of(int socket, std::string_view interface);

/// For people, where an echo proves no departure: that, and why. Empty where it does. `echoes`: the driver makes the
/// echoes (IFF_ECHO), else the kernel does at hand-over.
[[nodiscard]] std::string no_departure_notice(EchoProves configured, bool echoes, std::string_view driver);

}  // namespace canopen::socketcan
