#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace gateway::control {

/// What `status` told, as a table for people; nothing where the text is not what status_json() makes.
[[nodiscard]] std::optional<std::string> status_table(std::string_view status);

}  // namespace gateway::control
