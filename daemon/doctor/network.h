#pragma once

#include <sys/types.h>

#include <cstdint>
#include <optional>
#include <string>
#include <system_error>
#include <vector>

#include "bridges/mqtt/reach.h"
#include "config/model.h"
#include "daemon/doctor/line.h"
#include "daemon/doctor/presence.h"
#include "daemon/doctor/service.h"

namespace gateway::doctor {

/// One address to listen on, tried and given back at once.
struct PortFacts {
  std::string unknown_name{};        ///< Why the system knows no address of the name; empty: it does.
  std::error_code error{};           ///< Set: nobody can listen there now.
  std::optional<bool> of_gateway{};  ///< It is the gateway that listens there; nothing: that was not seen.
  bool needs_privilege = false;      ///< Root may take it, and the service's user may not.
};
/// `gateway`: its process; 0: not known.
[[nodiscard]] PortFacts try_port(const config::Endpoint& listen, pid_t gateway);

/// Whoever may have the port.
struct PortHolder {
  Presence gateway = Presence::absent;
  bool privileged = false;     ///< This program may take ports below 1024.
  std::string opener{};        ///< What opens those for the service; empty: nothing does.
  bool may_be_passed = false;  ///< systemd may be what opens it.
};
[[nodiscard]] Line judge(const config::Endpoint& listen, const PortFacts& facts, const PortHolder& holder);
/// PortHolder::opener of that address.
[[nodiscard]] std::string opener_of(const config::Endpoint& listen, const ServiceFacts& service, bool may_be_passed);

struct BrokerFacts {
  std::string unknown_name{};  ///< As above.
  std::vector<std::string> addresses{};
  bool lacks_files = false;  ///< Those of TLS are not there for this program: it was not tried.
  mqtt::Reach reach{};
  bool speaks_tls = false;  ///< To who spoke plainly, and was not answered as by a broker.
};
/// Begins no session there: a running gateway keeps its connection. Blocks for the system's look-up and `patience`.
/// `lacks_files`: one of those for TLS cannot be had.
[[nodiscard]] BrokerFacts try_broker(const config::Mqtt& mqtt, const config::Endpoint& broker, bool lacks_files,
                                     std::chrono::milliseconds patience);
[[nodiscard]] Line judge(const config::Endpoint& broker, const BrokerFacts& facts);

}  // namespace gateway::doctor
