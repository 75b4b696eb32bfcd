#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "config/model.h"

namespace gateway {

/// Makes a site a demo of it, which nobody takes for the plant: another name (demo_name()), another client id, loopback
/// addresses and brokers only, and never the ports of a plant (502, 9464). HTTP is on whatever the site says.
void make_demo(config::Model& model);

/// Puts what is taken on this machine to the next free port; what was changed, for people, a line each.
[[nodiscard]] std::vector<std::string> step_aside(config::Model& model);

}  // namespace gateway
