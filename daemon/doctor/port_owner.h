#pragma once

#include <sys/types.h>

#include <boost/asio/ip/tcp.hpp>
#include <optional>

namespace gateway::doctor {

/// Nobody else can listen at `at`, because somebody does: is it this process? It looks for the socket among those of
/// the process in /proc, which only root sees of others. Nothing: it could not be seen, or the process lives in another
/// network. `process`: 0 where it is not known.
[[nodiscard]] std::optional<bool> is_held_by(const boost::asio::ip::tcp::endpoint& at, pid_t process);

}  // namespace gateway::doctor
