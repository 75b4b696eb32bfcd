#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/awaitable.hpp>
#include <boost/asio/local/stream_protocol.hpp>
#include <cstddef>
#include <string>
#include <string_view>

#include "bridges/net/tasks.h"
#include "canopen/clock.h"
#include "daemon/control/service.h"

namespace gateway::control {

/// One client of the control socket: its requests are carried out beside each other, its answers sent as they come.
class Connection {
 public:
  /// Requests under way at a time; further ones are refused, but for stops.
  static constexpr std::size_t kMaxUnderWay = 64;
  /// Bytes of answers that may wait for a client that does not read them; then it is closed.
  static constexpr std::size_t kMaxWaiting = 1024UL * 1024;

  /// `service` outlives it. `user` is what SO_PEERCRED said of the client.
  Connection(boost::asio::local::stream_protocol::socket socket, std::string user, const Service& service);

  /// Returns when the connection ended and nothing of it is under way any more. A client that only ceased to send still
  /// gets its answers.
  boost::asio::awaitable<void> serve();
  /// Takes no more requests; what is under way is still answered.
  void take_no_more();
  /// Ends the connection. serve() returns once what was begun is answered by the service.
  void close();

  /// When it last sent or was sent something; TimePoint::max() while anything is under way for it.
  [[nodiscard]] canopen::TimePoint idle_since() const noexcept;

 private:
  boost::asio::awaitable<void> read_lines();
  /// Of what was received.
  boost::asio::awaitable<void> begin_whole_lines();
  void begin(std::string_view line);
  boost::asio::awaitable<void> carry_out(Asked asked);
  void send(std::string_view answer);
  boost::asio::awaitable<void> write_answers();

  boost::asio::local::stream_protocol::socket socket_;
  std::string user_;
  const Service& service_;
  std::string received_;     ///< The begin of a line.
  bool skipping_ = false;    ///< Up to the end of a line that is too long.
  std::string waiting_;      ///< Answers.
  std::size_t leaving_ = 0;  ///< Bytes of answers that are being written.
  bool writing_ = false;
  std::size_t under_way_ = 0;  ///< Requests.
  net::Tasks tasks_;           ///< All that runs but serve().
  canopen::TimePoint active_;
  canopen::TimePoint read_at_{};  ///< When the bytes at hand came.
};

}  // namespace gateway::control
