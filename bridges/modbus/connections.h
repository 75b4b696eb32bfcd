#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/awaitable.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <cstddef>
#include <cstdint>
#include <list>

#include "bridges/modbus/access_list.h"
#include "bridges/modbus/answers.h"
#include "bridges/modbus/client.h"
#include "bridges/modbus/units.h"
#include "canopen/clock.h"
#include "config/model.h"

namespace modbus {

/// Listens, decides who may connect, and owns the clients.
class Connections {
 public:
  /// `units` outlives the connections. Throws std::runtime_error for address ranges that are none.
  Connections(boost::asio::any_io_executor executor, const config::Modbus& settings, Units& units);

  /// Throws std::runtime_error; then nothing was started.
  void start();
  /// Ends listeners and connections; nothing more is asked of a drive.
  void close();
  boost::asio::awaitable<void> stop();

  [[nodiscard]] std::uint16_t port(std::size_t listen_index) const;
  [[nodiscard]] std::size_t clients() const noexcept { return clients_.size(); }
  [[nodiscard]] std::uint64_t refused() const noexcept { return refused_; }

 private:
  struct Listener {
    Listener(boost::asio::ip::tcp::acceptor opened, std::size_t index);
    boost::asio::ip::tcp::acceptor acceptor;
    std::size_t listen_index;
    canopen::Timer pause;
  };

  boost::asio::awaitable<void> accept_from(Listener& listener);
  void admit(boost::asio::ip::tcp::socket socket);
  boost::asio::awaitable<void> close_idle_clients();
  void spawn(boost::asio::awaitable<void> work);
  void on_end();

  boost::asio::any_io_executor executor_;
  const config::Modbus& settings_;
  AccessList readers_;
  AccessList writers_;
  Units& units_;
  Answers answers_;
  std::list<Listener> listeners_;
  std::list<Client> clients_;
  canopen::Timer idle_;
  canopen::Timer all_ended_;
  std::size_t running_ = 0;  ///< Coroutines.
  std::uint64_t refused_ = 0;
  bool stopping_ = false;
};

}  // namespace modbus
