#pragma once

#include <functional>
#include <string>

namespace alarms {

/// Makes the id of an activation.
using NewId = std::function<std::string()>;

/// 16 hexadecimal digits from the system's random source, so that no two activations share one, over restarts and
/// gateways too. Throws std::system_error where the system has no such source.
[[nodiscard]] std::string random_id();

}  // namespace alarms
