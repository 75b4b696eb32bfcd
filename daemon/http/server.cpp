#include "daemon/http/server.h"

#include <algorithm>
#include <boost/asio/redirect_error.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <boost/system/error_code.hpp>
#include <chrono>
#include <optional>
#include <utility>
#include <vector>

#include "bridges/net/tcp_options.h"
#include "daemon/http/admission.h"

namespace gateway::http {

using boost::asio::awaitable;
using boost::asio::redirect_error;
using boost::asio::use_awaitable;
using boost::asio::ip::tcp;
using boost::system::error_code;

namespace {

constexpr canopen::Duration kHousekeeping = std::chrono::seconds(1);
// What the system keeps for a client that does not take it (it doubles this). By itself it keeps up to 4 MB of each,
// and as long as that has room the slowest of them is served like the fastest.
constexpr int kSendBuffer = 64 * 1024;

}  // namespace

Server::Server(const boost::asio::any_io_executor& executor, const config::Http& settings, Respond respond,
               LiveSource live, net::Notices notices)
    : tasks_(executor),
      readers_(settings.read_from, "[http] read_from"),
      log_("HTTP", std::move(notices)),
      shared_{.respond = std::move(respond),
              .hosts = Hosts(settings.hosts),
              .live = std::move(live),
              .may_stream = [this](const boost::asio::ip::address& address) { return may_stream(address); },
              .answered = [this](unsigned status) { ++figures_.answers[status]; },
              .warn = [this](std::string_view address, std::string_view what) { log_.warn(address, what); }},
      owner_{.take = [this](tcp::socket socket, bool last) { take(std::move(socket), last); },
             .spawn = [this](awaitable<void> work) { tasks_.spawn(std::move(work)); },
             .log = log_},
      listener_(executor, settings.listen, owner_),
      housekeeping_(executor) {}

void Server::start() {
  listener_.start(std::nullopt);
  tasks_.spawn(keep_house());
}

void Server::close(const char* why) {
  stopping_ = true;
  listener_.close();
  for (Connection& client : clients_) {
    client.close(why);
  }
  housekeeping_.cancel();
}

awaitable<void> Server::stop() {
  close();
  co_await tasks_.all_ended();
}

const HttpFigures& Server::figures() {
  figures_.clients = clients_.size();
  return figures_;
}

void Server::take(tcp::socket socket, bool last) {
  error_code failed;
  const tcp::endpoint remote = socket.remote_endpoint(failed);
  if (failed || stopping_) {
    return;
  }
  const boost::asio::ip::address address = net::plain_address(remote.address());
  if (const char* const why = refusal(address, last)) {
    ++figures_.refused;
    log_.warn(address.to_string(), why);
    socket.shutdown(tcp::socket::shutdown_both, failed);
    return;
  }
  net::prepare(socket);
  socket.set_option(tcp::socket::send_buffer_size(kSendBuffer), failed);  // Where it is refused there is more room.
  serve(std::move(socket), address);
}

const char* Server::refusal(const boost::asio::ip::address& address, bool last) {
  if (!readers_.contains(address)) {
    return "refused: [http] read_from does not name it";
  }
  // Those that are on their way out already take no room.
  std::vector<Guest> guests;
  std::vector<Connection*> clients;
  for (Connection& client : clients_) {
    if (client.ended() == nullptr) {
      guests.push_back({client.from(), client.idle_since()});
      clients.push_back(&client);
    }
  }
  if (last && guests.empty()) {
    return "refused: no descriptor is left";
  }
  // With the last descriptor the server is as full as it can be.
  const Admission admission = admit(address, guests, last ? std::min(kMaxClients, guests.size()) : kMaxClients);
  if (admission.instead_of) {
    clients[*admission.instead_of]->close("disconnected: made room for another connection");
  }
  return admission.refusal;
}

bool Server::may_stream(const boost::asio::ip::address& address) const {
  const auto all = static_cast<std::size_t>(std::ranges::count_if(clients_, &Connection::streams));
  const auto same = static_cast<std::size_t>(std::ranges::count_if(
      clients_, [&address](const Connection& client) { return client.streams() && client.from() == address; }));
  return all < kMaxStreams && same < kMaxStreamsOfAddress;
}

void Server::serve(tcp::socket socket, const boost::asio::ip::address& address) {
  const auto client = clients_.emplace(clients_.end(), std::move(socket), address, shared_);
  log_.info(client->address(), "connected");
  tasks_.spawn(client->serve(), [this, client] {
    log_.info(client->address(), client->ended() == nullptr ? "has left" : client->ended());
    client->close("served");
    clients_.erase(client);
  });
}

awaitable<void> Server::keep_house() {
  while (!stopping_) {
    const canopen::TimePoint now = canopen::Clock::now();
    for (Connection& client : clients_) {
      client.look(now);
    }
    log_.sweep();
    error_code ignored;
    housekeeping_.expires_after(kHousekeeping);
    co_await housekeeping_.async_wait(redirect_error(use_awaitable, ignored));
  }
}

}  // namespace gateway::http
