#pragma once

#include <string>

#include "bridges/mqtt/topics.h"
#include "config/model.h"

namespace mqtt {

/// What `B/info` says: version, instance, buses, drives, and every signal with its object, unit, range, access and
/// topics.
[[nodiscard]] std::string info_json(const config::Model& model, const Topics& topics, std::string_view version,
                                    std::string_view instance);

}  // namespace mqtt
