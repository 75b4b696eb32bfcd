#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/awaitable.hpp>
#include <boost/asio/local/stream_protocol.hpp>
#include <cstddef>
#include <functional>
#include <list>
#include <string>

#include "canopen/clock.h"
#include "daemon/control/connection.h"
#include "daemon/control/listen.h"
#include "daemon/control/service.h"

namespace gateway::control {

/// The control socket: local clients that ask and command, a JSON object a line each way.
class Server {
 public:
  /// A further one takes the place of the one that is idle longest, though it may read a stream, and is refused where
  /// none is.
  static constexpr std::size_t kMaxClients = 32;
  /// Where it cannot listen it tries again this often.
  static constexpr canopen::Duration kRetry = std::chrono::seconds(3);

  /// For the log.
  struct Notices {
    std::function<void(const std::string&)> warning;
    std::function<void(const std::string&)> info;
  };

  Server(boost::asio::any_io_executor executor, Place place, Service service, Notices notices);
  ~Server();
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  /// Listens as soon as it can; where it cannot, that is told and everything else goes on.
  void start();
  /// Takes no more clients and requests; what is under way is still answered.
  void close();
  /// After the service has answered everything. Clients that do not read their answers are waited for, `patience` at
  /// most.
  boost::asio::awaitable<void> stop(canopen::Duration patience);

  [[nodiscard]] bool listening() const noexcept { return opened_.acceptor && opened_.acceptor->is_open(); }
  [[nodiscard]] std::size_t clients() const noexcept { return connections_.size(); }

 private:
  void remove_file();
  boost::asio::awaitable<void> listen();
  [[nodiscard]] bool open();
  boost::asio::awaitable<void> accept();
  void admit(boost::asio::local::stream_protocol::socket socket);
  [[nodiscard]] bool make_room();
  void spawn(boost::asio::awaitable<void> work);
  boost::asio::awaitable<void> until_idle(canopen::TimePoint end);

  boost::asio::any_io_executor executor_;
  Place place_;
  Service service_;
  http::LoopShare share_{};
  Notices notices_;
  Opened opened_;
  std::string told_;  ///< The problem that was told last.
  std::list<Connection> connections_;
  canopen::Timer retry_;
  canopen::Timer idle_;
  std::size_t running_ = 0;  ///< Coroutines.
  bool closed_ = false;
};

}  // namespace gateway::control
