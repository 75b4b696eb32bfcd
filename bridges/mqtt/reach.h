#pragma once

#include <chrono>
#include <string>
#include <vector>

#include "bridges/mqtt/tls_handshake.h"
#include "config/model.h"

namespace mqtt {

/// The broker can be reached at one of these addresses, and lives: with TLS it shakes hands as it has to; without, it
/// says something to a CONNECT of a version that nobody speaks, or closes (MQTT 5 §3.1.2.2), which a process that
/// stands still does not. No session begins there, nor ends one of our client id. Blocks for `patience`.
[[nodiscard]] bool reaches(const config::Endpoint& broker, const std::vector<std::string>& addresses,
                           const TlsFiles& files, std::chrono::milliseconds patience);

}  // namespace mqtt
