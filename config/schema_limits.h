#pragma once

#include <chrono>
#include <cstdint>
#include <limits>

#include "canopen/clock.h"

// Bounds of keys, shared by the key tables. Durations in nanoseconds, as KeyKind::duration counts them.

namespace config {

inline constexpr std::int64_t kMs = canopen::Duration(std::chrono::milliseconds(1)).count();
/// What an object of milliseconds in 16 bits holds (0x1017, event timers).
inline constexpr std::int64_t kMs16 = 65535 * kMs;
inline constexpr std::int64_t kMaxInteger = std::numeric_limits<std::int64_t>::max();
inline constexpr std::int64_t kMinInteger = std::numeric_limits<std::int64_t>::min();

}  // namespace config
