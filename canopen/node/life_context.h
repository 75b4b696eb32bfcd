#pragma once

#include <optional>
#include <string>

#include "canopen/clock.h"
#include "canopen/nmt.h"
#include "canopen/node/life.h"
#include "canopen/node/node_settings.h"

namespace canopen {

class Bus;
class SdoClient;

/// What was heard of a node since its last boot-up, loss, reset, or return of the bus.
struct Heard {
  bool boot_up = false;                     ///< A boot-up message that no configuration has answered yet.
  bool tpdo = false;                        ///< Whether that means operational depends on its error control.
  std::optional<NmtState> state{};          ///< Of the newest heartbeat or guarding answer.
  std::optional<TimePoint> heartbeat_at{};  ///< The newest heartbeat.
  bool guarding_asked = false;              ///< A guarding request has left: the next message is its answer.
  bool by_guarding = false;                 ///< The state comes from a guarding answer, and no heartbeat came since.
};

/// What the procedures of one life work with. All of it outlives them.
struct LifeContext {
  Bus& bus;
  SdoClient& sdo;
  const NodeSettings& settings;
  Heard& heard;            ///< Kept up to date by the node's frame handlers.
  std::string& half_done;  ///< What was written to the node by configurations that came to no end; empty: nothing.
  Life& life;
};

/// Waits for a heartbeat that was received at or after `since`; false where none comes within heartbeat_timeout from
/// now, or the life is over.
boost::asio::awaitable<bool> heartbeat_after(LifeContext context, TimePoint since);

}  // namespace canopen
