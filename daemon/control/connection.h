#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/awaitable.hpp>
#include <boost/asio/local/stream_protocol.hpp>
#include <cstddef>
#include <memory>
#include <string>
#include <string_view>

#include "bridges/net/tasks.h"
#include "canopen/clock.h"
#include "daemon/control/service.h"
#include "daemon/http/loop_share.h"

namespace gateway::control {

/// One client of the control socket: its requests are carried out beside each other, its answers sent as they come.
class Connection {
 public:
  /// Requests under way at a time; further ones are refused, but for stops.
  static constexpr std::size_t kMaxUnderWay = 64;
  /// Bytes of answers that may wait for a client that does not read them; then it is closed.
  static constexpr std::size_t kMaxWaiting = 1024UL * 1024;
  /// A stream is told nothing further while as much waits: what comes meanwhile, it loses.
  static constexpr std::size_t kMaxStreamWaiting = 64UL * 1024;
  /// Bytes of a stream's id as it stands in the lines: it is in each of them.
  static constexpr std::size_t kMaxStreamId = 64;

  /// `service` and `share` outlive it. `user` is what SO_PEERCRED said of the client.
  Connection(boost::asio::local::stream_protocol::socket socket, std::string user, const Service& service,
             http::LoopShare& share);

  /// Returns when the connection ended and nothing of it is under way any more. A client that only ceased to send still
  /// gets its answers.
  boost::asio::awaitable<void> serve();
  /// Takes no more requests; what is under way is still answered, but for a stream, which ends.
  void take_no_more();
  /// Ends the connection. serve() returns once what was begun is answered by the service.
  void close();

  /// When it last sent or was sent something; TimePoint::max() while anything but a stream is under
  /// way for it.
  [[nodiscard]] canopen::TimePoint idle_since() const noexcept;

 private:
  boost::asio::awaitable<void> read_lines();
  /// Of what was received.
  boost::asio::awaitable<void> begin_whole_lines();
  void begin(std::string_view line);
  boost::asio::awaitable<void> carry_out(Asked asked);
  void begin_stream(const Line& line);
  boost::asio::awaitable<void> tell_stream(std::string id, std::unique_ptr<Stream> stream);
  /// One piece of it, where the client has room. True: there is more at once.
  boost::asio::awaitable<bool> tell_piece(Stream& stream);
  /// It may take time of the loop. False: the stream is to end.
  boost::asio::awaitable<bool> await_turn();
  [[nodiscard]] bool may_tell() const { return socket_.is_open() && !ending_; }
  /// The client is gone, which nobody else notices while nothing is written to it.
  [[nodiscard]] bool hung_up();
  void send(std::string_view answer);
  void send_lines(std::string_view lines);
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
  http::LoopShare& share_;
  canopen::Timer turn_;    ///< Of the stream.
  bool streams_ = false;   ///< One runs.
  std::size_t piece_ = 0;  ///< Bytes of its newest one, which may wait beside `kMaxWaiting`.
  bool ending_ = false;
  net::Tasks tasks_;  ///< All that runs but serve().
  canopen::TimePoint active_;
  canopen::TimePoint read_at_{};  ///< When the bytes at hand came.
};

}  // namespace gateway::control
