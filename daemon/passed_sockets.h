#pragma once

#include <vector>

namespace gateway {

/// The descriptors of the sockets that the service manager bound and passed to this process (sd_listen_fds(3)); whoever
/// asks owns them. Empty where it is not started by one, or what the environment says is meant for another process.
[[nodiscard]] std::vector<int> passed_sockets();

}  // namespace gateway
