#pragma once

#include <string>

#include "config/load.h"

namespace config {

/// How long the drives bear to be without the gateway, as far as the configuration tells:
/// `longest restart: 1.5 s, then mixer1 misses it (supervise_gateway 2s)`. The drive counts from the gateway's last
/// heartbeat or request, which may be one period old when the gateway ends. `loaded` has a model.
[[nodiscard]] std::string longest_restart(const Loaded& loaded);

}  // namespace config
