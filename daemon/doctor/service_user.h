#pragma once

#include <pwd.h>

#include <functional>
#include <optional>

namespace gateway::doctor {

inline constexpr const char* kServiceUser = "canopen-gateway";

/// The service's user, where this program is root and the machine has that user; else null.
[[nodiscard]] const passwd* service_user();
/// This process is `user` from here on, with none of root's capabilities; false: it is not.
[[nodiscard]] bool become(const passwd& user);

/// What `work` returns as the service's user, 0 to 254, in a process of its own; nothing where there is no
/// service_user().
[[nodiscard]] std::optional<int> as_service_user(const std::function<int()>& work);

}  // namespace gateway::doctor
