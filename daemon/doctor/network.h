#pragma once

#include <cstdint>
#include <string>
#include <system_error>
#include <vector>

#include "bridges/mqtt/reach.h"
#include "config/model.h"
#include "daemon/doctor/line.h"

namespace gateway::doctor {

/// One address to listen on, tried and given back at once.
struct PortFacts {
  std::string unknown_name{};  ///< Why the system knows no address of the name; empty: it does.
  std::error_code error{};     ///< Set: nobody can listen there now.
};
[[nodiscard]] PortFacts try_port(const config::Endpoint& listen);

/// Whoever has the port.
struct PortHolder {
  bool gateway_runs = false;  ///< Then a port that is taken is its own.
  bool privileged = false;    ///< This program may take ports below 1024.
};
[[nodiscard]] Line judge(const config::Endpoint& listen, const PortFacts& facts, const PortHolder& holder);

struct BrokerFacts {
  std::string unknown_name{};  ///< As above.
  std::vector<std::string> addresses{};
  mqtt::Reach reach{};
};
/// Begins no session there: a running gateway keeps its connection. Blocks for the system's look-up and `patience`.
[[nodiscard]] BrokerFacts try_broker(const config::Mqtt& mqtt, const config::Endpoint& broker,
                                     std::chrono::milliseconds patience);
[[nodiscard]] Line judge(const config::Endpoint& broker, const BrokerFacts& facts);

}  // namespace gateway::doctor
