#pragma once

#include <optional>
#include <string>

#include "config/model.h"

namespace config {

/// `map --format json`; scripts rely on its keys and their order.
[[nodiscard]] std::string render_map_json(const Model& model);

/// Where a signal's value is published; nothing for one that cannot be read, or where single topics are off.
[[nodiscard]] std::optional<std::string> value_topic(const Model& model, const Drive& drive, const Signal& signal);
/// Where its commands are taken; nothing for one that cannot be written.
[[nodiscard]] std::optional<std::string> set_topic(const Model& model, const Drive& drive, const Signal& signal);

}  // namespace config
