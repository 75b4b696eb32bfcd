#pragma once

#include <boost/asio/awaitable.hpp>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "canopen/clock.h"
#include "canopen/node/node_events.h"
#include "canopen/node/node_settings.h"
#include "canopen/node/setup_session.h"

namespace canopen {

class SdoClient;

/// How a boot or a takeover went.
struct BootReport {
  std::uint8_t letter = kBootOk;              ///< kBootOk or a CiA 302-2 error letter as ASCII.
  std::string text;                           ///< Why it is a letter.
  bool interrupted = false;                   ///< Boot-up, loss, bus down or shutdown came in between: no verdict.
  std::vector<std::uint16_t> verified_tpdos;  ///< Their transmission type and timers are as they should be.
  std::vector<std::string> remarks;           ///< What the node lacks and was taken for granted.

  [[nodiscard]] bool ok() const noexcept { return letter == kBootOk && !interrupted; }
};

/// What a boot asks of the node beyond SDO.
class NmtLine {
 public:
  /// Waits for a heartbeat (no boot-up message) received after `since`; false where none comes in the node's
  /// heartbeat_timeout from now.
  virtual boost::asio::awaitable<bool> heartbeat_after(TimePoint since) = 0;
  /// The node may be started: nobody stopped it, and it did not stop by itself.
  [[nodiscard]] virtual bool may_start() const = 0;
  /// Everything is set up: from here on the node is configured, and its TPDOs mean what they should.
  virtual void settings_done(const BootReport& report) = 0;
  /// NMT start; the failure where it could not be sent or the node does not become operational.
  virtual boost::asio::awaitable<std::optional<BootFailure>> start_node() = 0;

 protected:
  ~NmtLine() = default;
};

/// Boots a node that is not operational (after CiA 302-2 §5): identity, error control, PDOs, further settings, its
/// heartbeat, NMT start. The arguments outlive the call.
boost::asio::awaitable<BootReport> boot(SdoClient& sdo, const NodeSettings& settings, NmtLine& line);

/// The part that boot and takeover share: everything by SDO, in the session's purpose. `error_control_written` is set
/// where the heartbeat time was changed. The arguments outlive the call.
boost::asio::awaitable<BootReport> check_settings(SetupSession& session, const NodeSettings& settings,
                                                  bool& error_control_written);

/// A heartbeat is to be expected of this node.
[[nodiscard]] bool expects_heartbeat(const NodeSettings& settings) noexcept;

}  // namespace canopen
