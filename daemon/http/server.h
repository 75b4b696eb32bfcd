#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/awaitable.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <list>

#include "bridges/net/access_list.h"
#include "bridges/net/connection_log.h"
#include "bridges/net/listener.h"
#include "bridges/net/tasks.h"
#include "canopen/clock.h"
#include "config/model.h"
#include "daemon/http/connection.h"
#include "daemon/http/site.h"

namespace gateway::http {

/// The HTTP server: shows what `respond` says, and takes no command. One loop, one thread.
class Server {
 public:
  /// Connections at a time. Each takes some 16 kB, and what waits for all of them WaitingBytes::kMost
  /// at most, beside a small answer each.
  static constexpr std::size_t kMaxClients = 256;

  /// Of them, that read the stream; and of one address. The rest is for those who ask.
  static constexpr std::size_t kMaxStreams = 192;
  static constexpr std::size_t kMaxStreamsOfAddress = 64;

  using Respond = std::function<Answer(const Request&)>;

  /// `settings` outlives the server. Throws std::runtime_error for address ranges that are none.
  Server(const boost::asio::any_io_executor& executor, const config::Http& settings, Respond respond, LiveSource live,
         net::Notices notices);
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  /// Listens. Never fails; what cannot be opened yet is told and tried again.
  void start();
  /// `why`: for the log.
  void close(const char* why = "disconnected: the gateway ends");
  /// After close(): no coroutine of it is left.
  [[nodiscard]] bool ended() const noexcept { return tasks_.none_runs(); }
  /// close(); returns when that is so.
  boost::asio::awaitable<void> stop();

  /// 0 while nothing listens.
  [[nodiscard]] std::uint16_t port() const { return listener_.port(); }
  [[nodiscard]] const HttpFigures& figures();

 private:
  void take(boost::asio::ip::tcp::socket socket, bool last);
  [[nodiscard]] const char* refusal(const boost::asio::ip::address& address, bool last);
  [[nodiscard]] bool may_stream(const boost::asio::ip::address& address) const;
  void serve(boost::asio::ip::tcp::socket socket, const boost::asio::ip::address& address);
  boost::asio::awaitable<void> keep_house();

  net::Tasks tasks_;
  net::AccessList readers_;
  net::ConnectionLog log_;
  Shared shared_;
  std::list<Connection> clients_;
  net::Listener::Owner owner_;
  net::Listener listener_;
  canopen::Timer housekeeping_;
  HttpFigures figures_;
  bool stopping_ = false;
};

}  // namespace gateway::http
