#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/awaitable.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <cstdint>
#include <functional>
#include <list>
#include <optional>
#include <string>
#include <vector>

#include "bridges/net/connection_log.h"
#include "bridges/net/spare_descriptor.h"
#include "canopen/clock.h"
#include "config/model.h"

namespace net {

/// One entry of `listen`: listens as soon as that can be done, and hands over who connects. An IPv6 socket takes IPv6
/// only, so that `0.0.0.0` and `[::]` can stand side by side.
class Listener {
 public:
  /// What it needs of its owner, who outlives it.
  struct Owner {
    /// The flag: it has the last descriptor, so it may stay only in another's place.
    std::function<void(boost::asio::ip::tcp::socket, bool)> take;
    /// Runs what is handed over; close() makes it return soon.
    std::function<void(boost::asio::awaitable<void>)> spawn;
    ConnectionLog& log;
    bool may_be_passed = false;  ///< The service manager may bind its sockets, and pass them.
    SpareDescriptor spare{};
  };

  /// `entry` outlives it.
  Listener(boost::asio::any_io_executor executor, const config::Endpoint& entry, Owner& owner);

  /// The address and port of a numeric entry; of a name, nothing.
  [[nodiscard]] std::optional<boost::asio::ip::tcp::endpoint> numeric() const;

  /// Serves `passed`, else opens sockets. A numeric address is open when this returns, even one that the machine does
  /// not have yet. What cannot be opened is tried again after 1 s, 2 s, and so on to 30 s; the log tells it once.
  void start(std::optional<boost::asio::ip::tcp::acceptor> passed);
  void close();

  /// That of the first socket; 0 while there is none.
  [[nodiscard]] std::uint16_t port() const;

 private:
  struct Socket {
    boost::asio::ip::tcp::endpoint asked_for;
    boost::asio::ip::tcp::acceptor acceptor;
    canopen::Timer pause;
  };
  using Endpoints = std::vector<boost::asio::ip::tcp::endpoint>;

  boost::asio::awaitable<void> open_in_time(bool tried);
  boost::asio::awaitable<Endpoints> resolve();
  /// Opens those that are not open yet; true when nothing is left to do.
  [[nodiscard]] bool open(const Endpoints& endpoints);
  [[nodiscard]] std::optional<boost::asio::ip::tcp::acceptor> bind(const boost::asio::ip::tcp::endpoint& at,
                                                                   boost::system::error_code& failed);
  void serve(const boost::asio::ip::tcp::endpoint& asked_for, boost::asio::ip::tcp::acceptor acceptor);
  boost::asio::awaitable<void> accept_from(Socket& socket);
  /// With the spare descriptor; true: somebody was taken.
  [[nodiscard]] bool take_last(Socket& socket);
  void warn_once(const boost::system::error_code& cause);

  boost::asio::any_io_executor executor_;
  const config::Endpoint& entry_;
  Owner& owner_;
  std::string name_;  ///< `0.0.0.0:502`, `[::]:502`
  std::list<Socket> sockets_;
  canopen::Timer retry_;
  canopen::Timer answered_;
  std::string told_;
  bool closed_ = false;
};

}  // namespace net
