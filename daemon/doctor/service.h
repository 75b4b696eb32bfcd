#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "daemon/doctor/files.h"
#include "daemon/doctor/line.h"

namespace gateway::doctor {

/// What the units of this machine say of the service, by their files and drop-ins. systemd itself is not asked: what
/// was edited and not yet loaded counts.
struct ServiceFacts {
  bool installed = false;                         ///< There is a canopen-gateway.service.
  std::vector<std::string> sockets{};             ///< ListenStream= of canopen-gateway.socket, where that is enabled.
  bool takes_any_port = false;                    ///< It has CAP_NET_BIND_SERVICE.
  bool sees_all_as_read_only = false;             ///< But `writable` (ProtectSystem=strict).
  std::vector<std::filesystem::path> writable{};  ///< ReadWritePaths=, and its own directories.
  bool sees_no_homes = false;                     ///< ProtectHome=
  bool has_own_tmp = false;                       ///< PrivateTmp=
};

/// Where systemd looks for units (systemd.unit(5)).
[[nodiscard]] std::vector<std::filesystem::path> unit_directories();
/// `directories`: the first one that has a unit, or a drop-in of that name, wins.
[[nodiscard]] ServiceFacts look_at_service(const std::vector<std::filesystem::path>& directories);

/// What the service cannot see or write because systemd keeps it from that. `control`: its socket; empty: none.
[[nodiscard]] Lines judge(const ServiceFacts& service, const std::vector<Wanted>& wanted, const std::string& control);

}  // namespace gateway::doctor
