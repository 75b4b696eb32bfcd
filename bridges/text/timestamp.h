#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "canopen/clock.h"

namespace text {

/// RFC 3339 in UTC with milliseconds: `2026-01-02T03:04:05.678Z`.
[[nodiscard]] std::string timestamp(canopen::WallTime time);
/// Reads exactly that form; nothing on any other text and on days that do not exist.
[[nodiscard]] std::optional<canopen::WallTime> parse_timestamp(std::string_view text);

}  // namespace text
