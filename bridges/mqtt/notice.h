#pragma once

#include <cstdint>
#include <functional>
#include <string>

namespace mqtt {

enum class Level : std::uint8_t { info, warning, error };

/// Takes what a person should find in the log. Called on the loop, never per message.
using Notice = std::function<void(Level, std::string)>;

}  // namespace mqtt
