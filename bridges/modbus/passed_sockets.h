#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <optional>
#include <span>
#include <vector>

#include "bridges/net/connection_log.h"

namespace modbus {

/// Duplicates of passed sockets, for a server that begins later. All listen, also those that stop_listening() ended:
/// of such one a service manager passes the same again.
[[nodiscard]] std::vector<int> duplicates_of(std::span<const int> descriptors);
/// Whoever has a duplicate of it would hold it open, and clients would wait for an answer that nobody gives.
void stop_listening(int descriptor);

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
