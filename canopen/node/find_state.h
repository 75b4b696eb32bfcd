#pragma once

#include <boost/asio/awaitable.hpp>
#include <cstdint>
#include <functional>
#include <string>

#include "canopen/node/life_context.h"

namespace canopen {

enum class FoundState : std::uint8_t {
  silent,           ///< No sign of life, and no SDO answer.
  operational,      ///< By heartbeat or guarding answer; by a TPDO where neither tells.
  stopped,          ///< By heartbeat or guarding answer; in this state a node answers no SDO.
  not_operational,  ///< Boot-up, or another state by heartbeat or guarding answer.
  unknown,          ///< It answers SDO, and nothing tells its state. Also where the life is over.
  not_asked         ///< No sign of life, and our request could not leave.
};

/// Learns the state of a node without changing it: listens for heartbeat_timeout and ends at the first sign. Without a
/// heartbeat 0x1017 is read; where that promises one, it is waited for. Where it promises none, the node answers
/// guarding and has no life guarding set (0x100C and 0x100D are 0: else one request would start it, CiA 301
/// §7.2.8.2.2), one guarding request is sent; where the node is to be supervised that way, and life guarding is not set
/// or is ours, the requests go on from then on (LifeContext::guarding). `tell`, which outlives the call, is called with
/// a text where that takes so long that people should know.
boost::asio::awaitable<FoundState> find_state(LifeContext context, const std::function<void(std::string)>& tell);

}  // namespace canopen
