#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/awaitable.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <cstddef>
#include <cstdint>
#include <list>
#include <span>

#include "bridges/modbus/answers.h"
#include "bridges/modbus/client.h"
#include "bridges/modbus/counts.h"
#include "bridges/modbus/units.h"
#include "bridges/net/access_list.h"
#include "bridges/net/connection_log.h"
#include "bridges/net/listener.h"
#include "bridges/net/tasks.h"
#include "canopen/clock.h"
#include "config/model.h"

namespace modbus {

/// Listens, decides who may connect, and owns the clients.
class Connections {
 public:
  /// `units` outlives the connections. Throws std::runtime_error for address ranges that are none.
  Connections(const boost::asio::any_io_executor& executor, const config::Modbus& settings, Units& units,
              net::Notices notices);

  /// `passed`: descriptors of listening sockets, which are owned from here on.
  void start(std::span<const int> passed);
  /// Ends listeners and connections; nothing more is asked of a drive. `why`: for the log.
  void close(const char* why = "disconnected: the gateway ends");
  boost::asio::awaitable<void> stop();
  [[nodiscard]] bool ended() const noexcept { return tasks_.none_runs(); }

  [[nodiscard]] std::uint16_t port(std::size_t listen_index) const;
  [[nodiscard]] std::size_t clients() const noexcept { return clients_.size(); }
  /// Closed at once since the start.
  [[nodiscard]] std::uint64_t refused() const noexcept { return refused_; }
  [[nodiscard]] const Counts& counts() const noexcept { return counts_; }

 private:
  void take(boost::asio::ip::tcp::socket socket, bool last);
  /// Nothing: it may stay; whoever makes room for it is gone then. Else why not.
  [[nodiscard]] const char* refusal(const boost::asio::ip::address& address, bool last);
  void count_refused();
  void serve(boost::asio::ip::tcp::socket socket, const boost::asio::ip::address& address);
  void tell_end(const Client& client);
  boost::asio::awaitable<void> keep_house();

  net::Tasks tasks_;
  const config::Modbus& settings_;
  net::AccessList readers_;
  net::AccessList writers_;
  Units& units_;
  Answers answers_;
  Counts counts_;
  std::list<Client> clients_;
  net::ConnectionLog log_;
  net::Listener::Owner owner_;
  std::list<net::Listener> listeners_;  ///< One for each entry of `listen`, in its order.
  canopen::Timer housekeeping_;
  std::uint64_t refused_ = 0;
  bool stopping_ = false;
};

}  // namespace modbus
