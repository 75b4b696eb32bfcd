#pragma once

#include <chrono>
#include <string>
#include <vector>

#include "bridges/mqtt/client.h"
#include "config/model.h"

namespace mqtt {

/// What a look for a broker came to.
struct Reach {
  bool good = false;
  std::string why{};  ///< Not, in words.
};

/// The broker can be reached at one of these addresses, and lives: it says something to a CONNECT of a version that
/// nobody speaks, or closes (MQTT 5 §3.1.2.2), which a process that stands still does not. So may a machine before it
/// that closes because there is no broker. No session begins there, nor ends one of our client id. Blocks for
/// `patience`.
[[nodiscard]] Reach reaches(const config::Endpoint& broker, const std::vector<std::string>& addresses,
                            const TlsFiles& files, std::chrono::milliseconds patience);

/// It takes a connection of ours: with our client id, user name, password and certificate, without a will and
/// subscriptions, and ended at once. `version`: 5 or 4 (MQTT 3.1.1) only; 0: either. Blocks for `patience`, or twice
/// that.
[[nodiscard]] Reach takes_us(const config::Endpoint& broker, const std::vector<std::string>& addresses,
                             const ClientSettings& client, int version, std::chrono::milliseconds patience);

}  // namespace mqtt
