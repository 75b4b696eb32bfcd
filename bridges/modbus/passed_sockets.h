#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <optional>
#include <span>
#include <vector>

#include "bridges/net/connection_log.h"

namespace modbus {

/// Listening sockets that a service manager bound and passed (sd_listen_fds(3)).
class PassedSockets {
 public:
  /// Owns the descriptors from here on; what is no listening TCP socket is told and closed.
  PassedSockets(const boost::asio::any_io_executor& executor, std::span<const int> descriptors,
                net::ConnectionLog& log);

  /// The one with just that address and port.
  [[nodiscard]] std::optional<boost::asio::ip::tcp::acceptor> take(const boost::asio::ip::tcp::endpoint& at);
  /// Tells and closes those that nobody took.
  void close_rest();

 private:
  std::vector<boost::asio::ip::tcp::acceptor> acceptors_;
  net::ConnectionLog& log_;
};

}  // namespace modbus
