#pragma once

#include <functional>
#include <optional>

namespace gateway::doctor {

inline constexpr const char* kServiceUser = "canopen-gateway";

/// This program is root, and the machine has that user: as_service_user() can be tried.
[[nodiscard]] bool is_service_user_known();

/// What `work` returns as the service's user, 0 to 254, in a process of its own; nothing where that
/// is not to be had.
[[nodiscard]] std::optional<int> as_service_user(const std::function<int()>& work);

}  // namespace gateway::doctor
