#include "daemon/control/server.h"

#include <algorithm>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/redirect_error.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <boost/system/error_code.hpp>
#include <exception>
#include <utility>

#include "daemon/control/accounts.h"

namespace gateway::control {

using boost::asio::awaitable;
using boost::asio::redirect_error;
using boost::asio::use_awaitable;
using boost::asio::local::stream_protocol;
using boost::system::error_code;

Server::Server(boost::asio::any_io_executor executor, Place place, Service service, Notices notices)
    : executor_(std::move(executor)),
      place_(std::move(place)),
      service_(std::move(service)),
      notices_(std::move(notices)),
      retry_(executor_),
      idle_(executor_) {}

Server::~Server() {
  remove_file();
}

void Server::start() {
  if (open()) {
    spawn(accept());
  } else {
    spawn(listen());
  }
}

void Server::close() {
  closed_ = true;
  retry_.cancel();
  remove_file();
  if (listening()) {
    error_code ignored;
    opened_.acceptor->close(ignored);
  }
  for (Connection& connection : connections_) {
    connection.take_no_more();
  }
}

// Once: its number may be that of another file afterwards.
void Server::remove_file() {
  if (listening()) {
    remove_socket(place_.path, std::exchange(opened_.file, {}));
  }
}

awaitable<void> Server::stop(canopen::Duration patience) {
  close();
  co_await until_idle(canopen::Clock::now() + patience);
  for (Connection& connection : connections_) {
    connection.close();
  }
  co_await until_idle(canopen::TimePoint::max());
}

awaitable<void> Server::until_idle(canopen::TimePoint end) {
  while (running_ != 0 && canopen::Clock::now() < end) {
    error_code ignored;
    idle_.expires_at(end);
    co_await idle_.async_wait(redirect_error(use_awaitable, ignored));
  }
}

bool Server::open() {
  opened_ = listen_at(executor_, place_);
  const std::string& news = opened_.problem.empty() ? opened_.remark : opened_.problem;
  if (!news.empty() && news != told_) {
    notices_.warning("control socket " + place_.path.string() + ": " + news);
  } else if (listening() && !told_.empty()) {
    notices_.info("control socket " + place_.path.string() + ": it can be reached now");
  }
  told_ = news;
  return listening();
}

awaitable<void> Server::listen() {
  while (!closed_) {
    error_code ignored;
    retry_.expires_after(kRetry);
    co_await retry_.async_wait(redirect_error(use_awaitable, ignored));
    if (!closed_ && open()) {
      co_await accept();
    }
  }
}

awaitable<void> Server::accept() {
  while (!closed_) {
    error_code failed;
    stream_protocol::socket socket = co_await opened_.acceptor->async_accept(redirect_error(use_awaitable, failed));
    if (!failed) {
      admit(std::move(socket));
    } else if (!closed_) {
      // No descriptor is left, for example: so that the loop does not spin on it.
      retry_.expires_after(std::chrono::milliseconds(100));
      co_await retry_.async_wait(redirect_error(use_awaitable, failed));
    }
  }
}

void Server::admit(stream_protocol::socket socket) {
  if (closed_ || (connections_.size() >= kMaxClients && !make_room())) {
    return;  // its end tells it
  }
  const std::string user = user_behind(socket.native_handle());
  connections_.emplace_back(std::move(socket), user, service_, share_);
  const auto admitted = std::prev(connections_.end());
  spawn([](Server& server, std::list<Connection>::iterator connection) -> awaitable<void> {
    co_await connection->serve();
    server.connections_.erase(connection);
  }(*this, admitted));
}

// A stop must not fail because others keep their connections open.
bool Server::make_room() {
  const auto longest = std::ranges::min_element(connections_, {}, &Connection::idle_since);
  if (longest->idle_since() == canopen::TimePoint::max()) {
    return false;
  }
  longest->close();
  return true;
}

void Server::spawn(awaitable<void> work) {
  ++running_;
  boost::asio::co_spawn(executor_, std::move(work), [this](const std::exception_ptr& failure) {
    if (--running_ == 0) {
      idle_.cancel();
    }
    if (failure) {
      std::rethrow_exception(failure);
    }
  });
}

}  // namespace gateway::control
