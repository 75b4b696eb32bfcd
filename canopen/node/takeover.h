#pragma once

#include <boost/asio/awaitable.hpp>
#include <cstdint>
#include <optional>

#include "canopen/clock.h"
#include "canopen/event.h"
#include "canopen/nmt.h"
#include "canopen/node/boot.h"
#include "canopen/node/node_settings.h"

namespace canopen {

class Bus;
class SdoClient;

/// What was heard of a node since its last boot-up, loss, or return of the bus.
struct NodeSigns {
  bool boot_up = false;                   ///< A boot-up message that no boot has answered yet.
  std::optional<NmtState> state;          ///< Of the newest heartbeat or guarding answer; a TPDO means operational.
  std::optional<TimePoint> heartbeat_at;  ///< The newest heartbeat.
  bool guarding_asked = false;            ///< A guarding request has left: the next message is its answer.
  bool by_guarding = false;               ///< The state comes from a guarding answer, and no heartbeat came since.
};

enum class FoundState : std::uint8_t {
  silent,           ///< No sign of life, and no SDO answer.
  operational,      ///< By heartbeat, guarding answer or TPDO.
  stopped,          ///< By heartbeat or guarding answer; in this state a node answers no SDO.
  not_operational,  ///< Boot-up, another state, or an SDO answer with none of these.
  interrupted       ///< Bus down, reset by command, or shutdown.
};

/// All of it outlives the search.
struct StateSearch {
  SdoClient& sdo;
  Bus& bus;
  const NodeSettings& settings;
  NodeSigns& signs;  ///< Kept up to date by the node's frame handlers, which notify `changed`.
  Event& changed;
};

/// Learns the state of a node without changing it: listens for heartbeat_timeout and ends at the first sign. Without
/// one, 0x1017 is read; where that promises a heartbeat less often than we listened, for one and a half of its periods
/// more; where it promises none and the node has guarding, one guarding request is sent.
boost::asio::awaitable<FoundState> learn_state(StateSearch search);

/// Looks whether a node that was found operational is as wanted: identity, heartbeat time, PDOs, further settings.
/// Reads only; nothing is written and no NMT command sent. What would have to be changed gives letter L, another
/// identity its own letter. A heartbeat time (0x1017) that differs counts as a change even where heartbeats arrive in
/// time: with policies write and verify it is what the site asked for. What the node lacks is no difference. The
/// arguments outlive the call.
boost::asio::awaitable<BootReport> inspect_running(SdoClient& sdo, const NodeSettings& settings);

}  // namespace canopen
