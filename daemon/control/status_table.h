#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace gateway::control {

/// Whether that is shown which changes by time alone.
enum class TableAges : std::uint8_t { shown, hidden };

/// What `status` told, as a table for people; nothing where the text is not what status_json() makes.
[[nodiscard]] std::optional<std::string> status_table(std::string_view status, TableAges ages = TableAges::shown);

/// Its `ts`; empty where it has none.
[[nodiscard]] std::string status_time(std::string_view status);

}  // namespace gateway::control
