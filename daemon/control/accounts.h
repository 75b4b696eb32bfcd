#pragma once

#include <sys/types.h>

#include <optional>
#include <string>

// Users and groups of this machine, as /etc/passwd and /etc/group have them. A directory server is not asked: it may be
// slow to answer, and the event loop does not wait.

namespace gateway::control {

/// The user's name, or its number where this machine has no name for it.
[[nodiscard]] std::string name_of_user(uid_t user);
[[nodiscard]] std::optional<gid_t> group_of(const std::string& name);

/// Who is at the other end of a connected local socket (SO_PEERCRED, unix(7)), as name_of_user() has it; "unknown"
/// where the kernel does not tell.
[[nodiscard]] std::string user_behind(int socket);

}  // namespace gateway::control
