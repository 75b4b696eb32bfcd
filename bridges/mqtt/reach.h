#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

#include "bridges/mqtt/client.h"
#include "config/model.h"

namespace mqtt {

/// What is at the other end, by the first it does.
enum class Manner : std::uint8_t {
  unknown,  ///< It did nothing, was not reached, or was not asked like this.
  connack,  ///< Only a broker says that.
  closes,   ///< As a broker may (DISCONNECT before it included), and much else.
  foreign   ///< No broker says that: its first packet is a CONNACK (MQTT 5 and 3.1.1 §3.2).
};

/// What a look for a broker came to.
struct Reach {
  bool good = false;
  std::string why{};                ///< Not, in words.
  Manner manner = Manner::unknown;  ///< Of reaches().
};

/// The broker can be reached at one of these addresses, and lives: it refuses a CONNECT of a version that nobody
/// speaks, or closes (MQTT 5 §3.1.2.2), which a process that stands still does not. So may a machine before it
/// that closes because there is no broker, or a port of TLS that is spoken to plainly: `manner` tells it apart from a
/// CONNACK. No session begins there, nor ends one of our client id. Blocks for `patience`.
[[nodiscard]] Reach reaches(const config::Endpoint& broker, const std::vector<std::string>& addresses,
                            const TlsFiles& files, std::chrono::milliseconds patience);

/// What is behind this port, spoken to plainly, answers a greeting of TLS with TLS, be it with a refusal. Blocks for
/// `patience`.
[[nodiscard]] bool speaks_tls(const config::Endpoint& broker, const std::vector<std::string>& addresses,
                              std::chrono::milliseconds patience);

/// It takes a connection of ours: with our client id, user name, password and certificate, without a will and
/// subscriptions, and ended at once. `version`: 5 or 4 (MQTT 3.1.1) only; 0: either. Blocks for `patience`, or twice
/// that.
[[nodiscard]] Reach takes_us(const config::Endpoint& broker, const std::vector<std::string>& addresses,
                             const ClientSettings& client, int version, std::chrono::milliseconds patience);

}  // namespace mqtt
