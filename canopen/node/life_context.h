#pragma once

#include <optional>
#include <string>

#include "canopen/clock.h"
#include "canopen/nmt.h"
#include "canopen/node/life.h"
#include "canopen/node/node_settings.h"

namespace canopen {

class Bus;
class NodeGuarding;
class SdoClient;

/// What was heard of a node since its last boot-up, loss, reset, or return of the bus.
struct Heard {
  bool boot_up = false;                     ///< A boot-up message that no configuration has answered yet.
  std::optional<TimePoint> tpdo_at{};       ///< The newest TPDO. Whether it means operational error control decides.
  std::optional<NmtState> state{};          ///< Of the newest heartbeat or guarding answer.
  std::optional<TimePoint> heartbeat_at{};  ///< The newest heartbeat, or answer to guarding that goes on.
  bool guarding_asked = false;              ///< A single guarding request has left: the next message is its answer.
  bool by_guarding = false;                 ///< The state comes from such an answer, and no heartbeat came since.
  std::optional<TimePoint> cyclic_at{};     ///< That heartbeat or answer, kept where it is long ago.
  Duration longest_gap{};                   ///< Between two of these; zero: no two were heard.
  bool stopped_by_us = false;               ///< Told so, and silent since, as a stopped node without error control is.
};

/// What the procedures of one life work with. All of it outlives them.
struct LifeContext {
  Bus& bus;
  SdoClient& sdo;
  NodeGuarding& guarding;
  const NodeSettings& settings;
  Heard& heard;            ///< Kept up to date by the node's frame handlers.
  std::string& half_done;  ///< What was written to the node by configurations that came to no end; empty: nothing.
  Life& life;
};

/// Waits for a heartbeat, or while guarding goes on for an answer to it, that was received at or after `since`; false
/// where none comes within heartbeat_timeout from now, or the life is over. Answers count only where their toggle bit
/// was seen to alternate.
boost::asio::awaitable<bool> heartbeat_after(LifeContext context, TimePoint since);

}  // namespace canopen
