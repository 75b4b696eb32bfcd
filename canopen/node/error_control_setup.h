#pragma once

#include <boost/asio/awaitable.hpp>
#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include "canopen/node/node_settings.h"
#include "canopen/node/setup_session.h"

namespace canopen {

/// A time as 0x1016 and 0x1017 hold it.
[[nodiscard]] inline Raw whole_ms(Duration duration) noexcept {
  return static_cast<Raw>(std::chrono::duration_cast<std::chrono::milliseconds>(duration).count());
}

struct ErrorControlOutcome {
  std::optional<BootFailure> failure;
  /// By what it is supervised: a node that keeps a heartbeat that will do is, although guarding was wanted.
  ErrorControlKind kind = ErrorControlKind::heartbeat;
  bool heartbeat_written = false;    ///< 0x1017 was.
  bool heartbeat_as_wanted = false;  ///< 0x1017 was read, and is as it should be.
};

/// 0x1017 alone. A period that differs, but fits heartbeat_timeout, will do while inspecting, and after it was written:
/// some nodes round it. Remarks go to `remarks`.
boost::asio::awaitable<ErrorControlOutcome> set_up_heartbeat(SetupSession& session, std::vector<std::string>& remarks);

/// The same, and how the node watches over us where it is to: an entry of 0x1016, or life guarding. For guarding,
/// 0x100C and 0x100D are read first: where life guarding is set, and not by us, no request begins and those that went
/// on after a loss end (`not_configured`, or `left_alone`), else the requests begin (LifeContext::guarding) and go on.
boost::asio::awaitable<ErrorControlOutcome> set_up_error_control(SetupSession& session,
                                                                 std::vector<std::string>& remarks);

}  // namespace canopen
