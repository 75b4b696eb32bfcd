#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <string>
#include <vector>

#include "config/model.h"

namespace modbus {

/// `0.0.0.0:502`, `[::]:502`
[[nodiscard]] std::string to_string(const config::Endpoint& endpoint);

/// Listens on every address of the endpoint's host. Throws std::runtime_error that names endpoint, cause and remedy.
/// An IPv6 listener takes IPv6 only, so that `0.0.0.0` and `[::]` can stand side by side.
[[nodiscard]] std::vector<boost::asio::ip::tcp::acceptor> open_listeners(boost::asio::any_io_executor executor,
                                                                         const config::Endpoint& endpoint);

}  // namespace modbus
