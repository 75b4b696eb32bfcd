#pragma once

#include <string>

#include "config/model.h"

namespace net {

/// Ports below it need a privilege (CAP_NET_BIND_SERVICE), which the service does not have.
inline constexpr unsigned kFirstOrdinaryPort = 1024;

/// `0.0.0.0:502`, `[::]:502`: as `listen` and as systemd's ListenStream= have it.
[[nodiscard]] std::string text_of(const config::Endpoint& entry);

/// What to do so that the service can listen at `entry`, which is below kFirstOrdinaryPort. `may_be_passed`: systemd
/// may open it in its place.
[[nodiscard]] std::string privileged_port_remedy(const config::Endpoint& entry, bool may_be_passed);

}  // namespace net
