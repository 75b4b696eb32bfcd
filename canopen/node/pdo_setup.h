#pragma once

#include <boost/asio/awaitable.hpp>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "canopen/node/node_settings.h"
#include "canopen/node/setup_session.h"

namespace canopen {

enum class PdoRole : std::uint8_t { transmit, receive };

struct PdoSetupOutcome {
  std::optional<BootFailure> failure;
  /// Transmission type and event timer were shown by the node as they should be.
  bool timing_confirmed = false;
  /// Communication or mapping object missing: the documented default is taken for granted.
  bool absent = false;
  std::vector<std::string> remarks{};  ///< Times that differ and will do.
};

/// Makes one PDO so (CiA 301 §7.5.2.33 to §7.5.2.38), or only looks whether it is: COB-ID, transmission type, inhibit
/// time, event timer and mapping. Writes nothing where nothing differs; else disables the PDO, writes what differs,
/// enables it and reads back what it wrote. A mapping that may be written is compared while the PDO is disabled, for
/// some devices clear it then. Objects that the node lacks are taken to be as documented, but for an event timer that
/// is required (PdoSettings::event_timer_required): without it BootResult::not_configured. A time of a TPDO
/// that may be written need not be exact (allow_rounding()). `pdo` and `session` outlive the call.
boost::asio::awaitable<PdoSetupOutcome> set_up_pdo(SetupSession& session, PdoRole role, const PdoSettings& pdo);

}  // namespace canopen
