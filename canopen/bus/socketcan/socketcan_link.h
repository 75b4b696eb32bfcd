#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <functional>
#include <memory>
#include <string>

#include "canopen/bus/echo.h"
#include "canopen/bus/link.h"

namespace canopen {

/// What an operator should know of an interface: a receive buffer smaller than asked for, an interface that confirms on
/// hand-over, a socket that could not be opened. Called from the loop, once per cause and appearance of the interface.
using LinkNotice = std::function<void(std::string)>;

/// A SocketCAN interface as a link (RAW socket, recvmmsg, kernel receive stamps, error frames, SO_RXQ_OVFL, own frames
/// as echoes). An interface that is missing, down or pulled is reported as BusCondition::down and looked for again; one
/// that is created anew, or comes back, is bound anew. `echo` decides what is said of a frame's departure, nothing
/// else. Link::open() throws std::system_error where the system gives no netlink socket.
[[nodiscard]] std::unique_ptr<Link> make_socketcan_link(boost::asio::any_io_executor executor, std::string interface,
                                                        LinkNotice notice = {},
                                                        EchoProves echo = EchoProves::by_driver);

}  // namespace canopen
