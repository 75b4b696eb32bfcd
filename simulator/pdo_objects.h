#pragma once

#include <cstdint>
#include <functional>

#include "simulator/object_dictionary.h"
#include "simulator/pdo_settings.h"

namespace simulator {

/// Adds the communication and mapping objects of one PDO. `settings` and `context` outlive the dictionary's use of
/// them; `changed` runs after every accepted write.
void define_pdo_objects(ObjectDictionary& dictionary, const PdoContext& context, std::uint8_t number, bool transmit,
                        PdoSettings& settings, std::function<void()> changed);

}  // namespace simulator
