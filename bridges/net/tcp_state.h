#pragma once

#include <chrono>
#include <optional>

namespace net {

/// What Linux knows of a TCP connection. Apart, because <linux/tcp.h>, which alone has all of it, cannot stand beside
/// <netinet/tcp.h>.

/// Since the last data came. Nothing: unknown.
[[nodiscard]] std::optional<std::chrono::milliseconds> milliseconds_since_received(int socket);

/// The other end takes nothing at present. False where the kernel does not tell (before Linux 5.4).
[[nodiscard]] bool has_shut_window(int socket);

}  // namespace net
