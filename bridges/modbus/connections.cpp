#include "bridges/modbus/connections.h"

#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>

#include <algorithm>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/redirect_error.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <boost/system/error_code.hpp>
#include <chrono>
#include <exception>
#include <string>
#include <utility>
#include <vector>

#include "bridges/modbus/admission.h"
#include "bridges/modbus/listen.h"

namespace modbus {
namespace {

using boost::asio::awaitable;
using boost::asio::redirect_error;
using boost::asio::use_awaitable;
using boost::asio::ip::tcp;
using boost::system::error_code;

// After a failed accept (no descriptor left), so that the loop does not spin on it.
constexpr canopen::Duration kAcceptPause = std::chrono::milliseconds(100);

// The rest of a request comes at once, or never.
constexpr canopen::Duration kHalfRequest = std::chrono::seconds(5);
constexpr canopen::Duration kHousekeeping = std::chrono::seconds(1);

// Keepalive does not probe while an answer waits for its acknowledgement.
constexpr int kUnacknowledgedMilliseconds = 30'000;

// A client whose cable was pulled is noticed after one minute, not after hours.
constexpr int kKeepaliveIdleSeconds = 30;
constexpr int kKeepaliveIntervalSeconds = 10;
constexpr int kKeepaliveProbes = 3;

void set_integer(tcp::socket& socket, int level, int option, int value) {
  // Where the kernel refuses one of these the connection works all the same.
  ::setsockopt(socket.native_handle(), level, option, &value, sizeof value);
}

void prepare(tcp::socket& socket) {
  set_integer(socket, IPPROTO_TCP, TCP_NODELAY, 1);
  set_integer(socket, SOL_SOCKET, SO_KEEPALIVE, 1);
  set_integer(socket, IPPROTO_TCP, TCP_KEEPIDLE, kKeepaliveIdleSeconds);
  set_integer(socket, IPPROTO_TCP, TCP_KEEPINTVL, kKeepaliveIntervalSeconds);
  set_integer(socket, IPPROTO_TCP, TCP_KEEPCNT, kKeepaliveProbes);
  set_integer(socket, IPPROTO_TCP, TCP_USER_TIMEOUT, kUnacknowledgedMilliseconds);
}

}  // namespace

Connections::Listener::Listener(tcp::acceptor opened, std::size_t index)
    : acceptor(std::move(opened)), listen_index(index), pause(acceptor.get_executor()) {}

Connections::Connections(boost::asio::any_io_executor executor, const config::Modbus& settings, Units& units,
                         Notices notices)
    : executor_(std::move(executor)),
      settings_(settings),
      readers_(settings.read_from, "[modbus] read_from"),
      writers_(settings.write_from, "[modbus] write_from"),
      units_(units),
      log_(std::move(notices)),
      housekeeping_(executor_),
      all_ended_(executor_) {}

void Connections::start() {
  std::list<Listener> opened;
  for (std::size_t i = 0; i < settings_.listen.size(); ++i) {
    for (tcp::acceptor& acceptor : open_listeners(executor_, settings_.listen[i])) {
      opened.emplace_back(std::move(acceptor), i);
    }
  }
  listeners_ = std::move(opened);
  for (Listener& listener : listeners_) {
    spawn(accept_from(listener));
  }
  for (const config::Endpoint& endpoint : settings_.listen) {
    log_.info(to_string(endpoint), "listening");
  }
  spawn(close_silent_clients());
}

void Connections::close() {
  stopping_ = true;
  for (Listener& listener : listeners_) {
    error_code ignored;
    listener.acceptor.close(ignored);
    listener.pause.cancel();
  }
  for (Client& client : clients_) {
    client.close("the gateway ends");
  }
  housekeeping_.cancel();
}

awaitable<void> Connections::stop() {
  close();
  while (running_ != 0) {
    error_code ignored;
    all_ended_.expires_at(canopen::TimePoint::max());
    co_await all_ended_.async_wait(redirect_error(use_awaitable, ignored));
  }
}

std::uint16_t Connections::port(std::size_t listen_index) const {
  const auto found = std::ranges::find(listeners_, listen_index, &Listener::listen_index);
  error_code ignored;
  return found == listeners_.end() ? std::uint16_t{0} : found->acceptor.local_endpoint(ignored).port();
}

void Connections::spawn(awaitable<void> work) {
  ++running_;
  boost::asio::co_spawn(executor_, std::move(work), [this](const std::exception_ptr& failure) {
    on_end();
    if (failure) {
      std::rethrow_exception(failure);
    }
  });
}

void Connections::on_end() {
  if (--running_ == 0) {
    all_ended_.cancel();
  }
}

awaitable<void> Connections::accept_from(Listener& listener) {
  while (!stopping_) {
    error_code failed;
    tcp::socket socket = co_await listener.acceptor.async_accept(redirect_error(use_awaitable, failed));
    if (!failed) {
      take(std::move(socket));
    } else if (!stopping_ && failed != boost::asio::error::connection_aborted) {
      log_.warn(to_string(settings_.listen[listener.listen_index]), "cannot take a connection: " + failed.message());
      listener.pause.expires_after(kAcceptPause);
      co_await listener.pause.async_wait(redirect_error(use_awaitable, failed));
    }
  }
}

void Connections::take(tcp::socket socket) {
  error_code failed;
  const tcp::endpoint remote = socket.remote_endpoint(failed);
  if (failed || stopping_) {
    return;
  }
  const boost::asio::ip::address address = plain_address(remote.address());
  if (const char* const why = refusal(address)) {
    // Accepted and closed at once: the client learns it now and does not wait in the backlog until its own timeout.
    units_.gateway().set_refused(++refused_);
    log_.warn(address.to_string(), std::string("refused: ") + why);
    socket.shutdown(tcp::socket::shutdown_both, failed);
    return;
  }
  prepare(socket);
  serve(std::move(socket), address);
}

const char* Connections::refusal(const boost::asio::ip::address& address) {
  if (!readers_.contains(address)) {
    return "[modbus] read_from does not name it";
  }
  // Those that are on their way out already take no room.
  std::vector<Caller> callers;
  std::vector<Client*> clients;
  for (Client& client : clients_) {
    if (client.ended() == nullptr) {
      callers.push_back({boost::asio::ip::make_address(client.address()), client.may_write(), client.idle_since()});
      clients.push_back(&client);
    }
  }
  const Admission admission = admit({.address = address, .may_write = writers_.contains(address)}, callers,
                                    settings_.max_clients, canopen::Clock::now());
  if (admission.instead_of) {
    clients[*admission.instead_of]->close("made room for a client of write_from");
  }
  return admission.refusal;
}

void Connections::serve(tcp::socket socket, const boost::asio::ip::address& address) {
  const auto client = clients_.emplace(clients_.end(), std::move(socket), address.to_string(),
                                       writers_.contains(address), units_, answers_);
  log_.info(client->address(), client->may_write() ? "connected" : "connected, may read only");
  units_.gateway().set_clients(clients_.size());
  ++running_;
  boost::asio::co_spawn(executor_, client->serve(), [this, client](const std::exception_ptr& failure) {
    tell_end(*client);
    client->close("served");
    clients_.erase(client);
    units_.gateway().set_clients(clients_.size());
    on_end();
    if (failure) {
      std::rethrow_exception(failure);
    }
  });
}

void Connections::tell_end(const Client& client) {
  if (client.sent_garbage()) {
    log_.warn(client.address(), "disconnected: what it sent is no Modbus TCP");
  } else if (client.ended() != nullptr) {
    log_.info(client.address(), std::string("disconnected: ") + client.ended());
  } else {
    log_.info(client.address(), "has left");
  }
}

awaitable<void> Connections::close_silent_clients() {
  while (!stopping_) {
    const canopen::TimePoint now = canopen::Clock::now();
    const bool may_be_idle = settings_.idle_timeout == canopen::Duration::zero();
    for (Client& client : clients_) {
      const auto idle = client.idle_since();
      const auto half = client.half_since();
      if (idle && half && now - *half >= kHalfRequest) {
        client.close("the rest of its request did not come");
      } else if (idle && !may_be_idle && now - *idle >= settings_.idle_timeout) {
        client.close("idle");
      }
    }
    log_.sweep();
    error_code ignored;
    housekeeping_.expires_after(kHousekeeping);
    co_await housekeeping_.async_wait(redirect_error(use_awaitable, ignored));
  }
}

}  // namespace modbus
