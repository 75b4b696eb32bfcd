#pragma once

#include <string>

#include "canopen/node/node_settings.h"
#include "config/model.h"

namespace gateway::compare {

/// What is to be done about a setting that differs, behind `; `.
[[nodiscard]] std::string remedy_of(canopen::SetupPolicy policy, const config::Drive& drive);

}  // namespace gateway::compare
