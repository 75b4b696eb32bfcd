#include "bridges/modbus/connections.h"

#include <algorithm>
#include <boost/asio/redirect_error.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <boost/system/error_code.hpp>
#include <chrono>
#include <iterator>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "bridges/modbus/admission.h"
#include "bridges/modbus/passed_sockets.h"
#include "bridges/net/tcp_options.h"

namespace modbus {
namespace {

using boost::asio::awaitable;
using boost::asio::redirect_error;
using boost::asio::use_awaitable;
using boost::asio::ip::tcp;
using boost::system::error_code;

// The rest of a request comes at once, or never.
constexpr canopen::Duration kHalfRequest = std::chrono::seconds(5);
constexpr const char* kNoDescriptor = "refused: no descriptor is left";
constexpr canopen::Duration kHousekeeping = std::chrono::seconds(1);

}  // namespace

Connections::Connections(const boost::asio::any_io_executor& executor, const config::Modbus& settings, Units& units,
                         net::Notices notices)
    : tasks_(executor),
      settings_(settings),
      readers_(settings.read_from, "[modbus] read_from"),
      writers_(settings.write_from, "[modbus] write_from"),
      units_(units),
      log_("Modbus", std::move(notices)),
      owner_{.take = [this](tcp::socket socket, bool last) { take(std::move(socket), last); },
             .spawn = [this](awaitable<void> work) { tasks_.spawn(std::move(work)); },
             .log = log_,
             .may_be_passed = true},
      housekeeping_(executor) {
  for (const config::Endpoint& entry : settings.listen) {
    listeners_.emplace_back(executor, entry, owner_);
  }
}

void Connections::start(std::span<const int> passed) {
  PassedSockets sockets(housekeeping_.get_executor(), passed, log_);
  for (net::Listener& listener : listeners_) {
    const std::optional<tcp::endpoint> at = listener.numeric();
    listener.start(at ? sockets.take(*at) : std::nullopt);
  }
  sockets.close_rest();
  tasks_.spawn(keep_house());
}

void Connections::close(const char* why) {
  stopping_ = true;
  for (net::Listener& listener : listeners_) {
    listener.close();
  }
  for (Client& client : clients_) {
    client.close(why);
  }
  housekeeping_.cancel();
}

awaitable<void> Connections::stop() {
  close();
  co_await tasks_.all_ended();
}

std::uint16_t Connections::port(std::size_t listen_index) const {
  return std::next(listeners_.begin(), static_cast<std::ptrdiff_t>(listen_index))->port();
}

void Connections::take(tcp::socket socket, bool last) {
  error_code failed;
  const tcp::endpoint remote = socket.remote_endpoint(failed);
  if (failed || stopping_) {
    return;
  }
  const boost::asio::ip::address address = net::plain_address(remote.address());
  if (const char* const why = refusal(address, last)) {
    // Accepted and closed at once: the client learns it now and does not wait in the backlog until its own timeout.
    count_refused();
    log_.warn(address.to_string(), why);
    socket.shutdown(tcp::socket::shutdown_both, failed);
    return;
  }
  net::prepare(socket);
  serve(std::move(socket), address);
}

void Connections::count_refused() {
  units_.gateway().set_refused(++refused_);
}

const char* Connections::refusal(const boost::asio::ip::address& address, bool last) {
  if (!readers_.contains(address)) {
    return "refused: [modbus] read_from does not name it";
  }
  // Those that are on their way out already take no room.
  std::vector<Caller> callers;
  std::vector<Client*> clients;
  for (Client& client : clients_) {
    if (client.ended() == nullptr) {
      callers.push_back({client.from(), client.may_write(), client.idle_since()});
      clients.push_back(&client);
    }
  }
  if (last && callers.empty()) {
    return kNoDescriptor;
  }
  // With the last descriptor the server is as full as with max_clients.
  const std::size_t room = last ? std::min(settings_.max_clients, callers.size()) : settings_.max_clients;
  const Admission admission =
      admit({.address = address, .may_write = writers_.contains(address)}, callers, room, canopen::Clock::now());
  if (admission.instead_of) {
    Client& leaves = *clients[*admission.instead_of];
    leaves.close(leaves.from() == address ? "disconnected: made room for a newer connection of its address"
                                          : "disconnected: made room for a client of write_from");
  }
  return admission.refusal != nullptr && last ? kNoDescriptor : admission.refusal;
}

void Connections::serve(tcp::socket socket, const boost::asio::ip::address& address) {
  const auto client = clients_.emplace(clients_.end(), std::move(socket), address, writers_.contains(address), units_,
                                       answers_, counts_);
  log_.info(client->address(), client->may_write() ? "connected" : "connected, may read only");
  units_.gateway().set_clients(clients_.size());
  tasks_.spawn(client->serve(), [this, client] {
    tell_end(*client);
    client->close("served");
    clients_.erase(client);
    units_.gateway().set_clients(clients_.size());
  });
}

void Connections::tell_end(const Client& client) {
  if (client.sent_garbage()) {
    ++counts_.garbage;
    log_.warn(client.address(), "disconnected: what it sent is no Modbus TCP");
  } else if (client.came_late()) {
    count_refused();
    log_.warn(client.address(),
              "refused: its first request waited for longer than a second before it could be taken; nothing of it was "
              "carried out");
  } else {
    log_.info(client.address(), client.ended() == nullptr ? "has left" : client.ended());
  }
}

awaitable<void> Connections::keep_house() {
  while (!stopping_) {
    const canopen::TimePoint now = canopen::Clock::now();
    const bool may_be_idle = settings_.idle_timeout == canopen::Duration::zero();
    for (Client& client : clients_) {
      const auto idle = client.idle_since();
      const auto half = client.half_since();
      if (idle && half && now - *half >= kHalfRequest) {
        client.close("disconnected: the rest of its request did not come");
      } else if (idle && !may_be_idle && now - *idle >= settings_.idle_timeout) {
        client.close("disconnected: idle");
      } else {
        client.look_after_slow_reader();
      }
    }
    log_.sweep();
    error_code ignored;
    housekeeping_.expires_after(kHousekeeping);
    co_await housekeeping_.async_wait(redirect_error(use_awaitable, ignored));
  }
}

}  // namespace modbus
