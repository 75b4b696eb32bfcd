#pragma once

#include <boost/asio/awaitable.hpp>
#include <optional>
#include <string>
#include <vector>

#include "canopen/node/setup_session.h"

namespace canopen {

/// How the node watches over us: the entry of 0x1016 that has our node id is as `supervise_gateway` says, others with
/// our id are cleared (CiA 301 §7.5.2.19). Remarks go to `remarks`.
boost::asio::awaitable<std::optional<BootFailure>> set_up_consumer(SetupSession& session,
                                                                   std::vector<std::string>& remarks);

/// It is not to watch over us. An entry with our node id that somebody else left trips it where our heartbeat comes too
/// seldom for that: a remark names it. One that our heartbeat never keeps is cleared while configuring. Never a
/// failure: a node that does not show its table boots without.
boost::asio::awaitable<void> look_at_consumers(SetupSession& session, std::vector<std::string>& remarks);

}  // namespace canopen
