#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace gateway::control {

/// For people: what the gateway tells of its buses (bus_reports()). Nothing where it is no such text.
[[nodiscard]] std::optional<std::string> bus_table(std::string_view buses);

}  // namespace gateway::control
