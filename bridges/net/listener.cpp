#include "bridges/net/listener.h"

#include <netinet/in.h>
#include <sys/socket.h>

#include <algorithm>
#include <boost/asio/ip/v6_only.hpp>
#include <boost/asio/redirect_error.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <boost/system/error_code.hpp>
#include <cerrno>
#include <chrono>
#include <utility>

#include "bridges/net/look_up.h"
#include "bridges/net/privileged_port.h"

namespace net {

using boost::asio::awaitable;
using boost::asio::redirect_error;
using boost::asio::use_awaitable;
using boost::asio::ip::tcp;
using boost::system::error_code;

namespace {

constexpr canopen::Duration kFirstRetry = std::chrono::seconds(1);
constexpr canopen::Duration kLastRetry = std::chrono::seconds(30);

// After a failed accept, so that the loop does not spin on it. Who connects waits meanwhile in the system's queue.
constexpr canopen::Duration kAcceptPause = std::chrono::milliseconds(100);

std::string remedy(const error_code& cause, const config::Endpoint& entry, bool may_be_passed) {
  if (cause == boost::asio::error::address_in_use) {
    return "another program listens there (`ss -ltnp` shows which): stop it, or take another port";
  }
  if (cause == boost::asio::error::access_denied && entry.port < kFirstOrdinaryPort) {
    return privileged_port_remedy(entry, may_be_passed);
  }
  if (cause == boost::asio::error::address_family_not_supported) {
    return "this system does not have that kind of address: leave the entry out";
  }
  if (cause.category() == boost::asio::error::get_netdb_category() ||
      cause.category() == boost::asio::error::get_addrinfo_category()) {
    return "the name must be known here (`getent hosts` shows whether it is), or write a numeric address";
  }
  return "this machine must have the address (`ip address` shows which it has): take one of these, or 0.0.0.0 or [::] "
         "for all";
}

bool is_absent(const error_code& cause) {
  return cause == error_code(EADDRNOTAVAIL, boost::system::system_category());
}

// A name may stand for an address of a kind that this machine does not have (localhost without IPv6).
bool is_of_no_use(const error_code& cause) {
  return cause == boost::asio::error::address_family_not_supported || is_absent(cause);
}

bool has_no_descriptor(const error_code& cause) {
  return cause == boost::asio::error::no_descriptors || cause == error_code(ENFILE, boost::system::system_category());
}

}  // namespace

Listener::Listener(boost::asio::any_io_executor executor, const config::Endpoint& entry, Owner& owner)
    : executor_(std::move(executor)),
      entry_(entry),
      owner_(owner),
      name_(text_of(entry)),
      retry_(executor_),
      answered_(executor_) {}

std::optional<tcp::endpoint> Listener::numeric() const {
  error_code failed;
  const auto address = boost::asio::ip::make_address(entry_.host, failed);
  return failed ? std::nullopt : std::optional(tcp::endpoint(address, entry_.port));
}

void Listener::start(std::optional<tcp::acceptor> passed) {
  const std::optional<tcp::endpoint> at = numeric();
  if (passed) {
    error_code failed;
    serve(passed->local_endpoint(failed), std::move(*passed));
    owner_.log.own_info(name_, "listening on the socket that the service manager passed");
  } else if (!at || !open({*at})) {
    owner_.spawn(open_in_time(at.has_value()));
  }
}

void Listener::close() {
  closed_ = true;
  for (Socket& socket : sockets_) {
    error_code ignored;
    socket.acceptor.close(ignored);
    socket.pause.cancel();
  }
  retry_.cancel();
  answered_.cancel();
}

std::uint16_t Listener::port() const {
  error_code failed;
  return sockets_.empty() ? std::uint16_t{0} : sockets_.front().acceptor.local_endpoint(failed).port();
}

awaitable<void> Listener::open_in_time(bool tried) {
  for (canopen::Duration pause = kFirstRetry; !closed_; pause = std::min(2 * pause, kLastRetry)) {
    if (tried) {
      error_code ignored;
      retry_.expires_after(pause);
      co_await retry_.async_wait(redirect_error(use_awaitable, ignored));
    }
    tried = true;
    Endpoints endpoints;
    if (!closed_) {
      endpoints = co_await resolve();
    }
    if (closed_ || (!endpoints.empty() && open(endpoints))) {
      co_return;
    }
  }
}

awaitable<Listener::Endpoints> Listener::resolve() {
  if (const std::optional<tcp::endpoint> at = numeric()) {
    co_return Endpoints{*at};
  }
  error_code failed = boost::asio::error::operation_aborted;
  Endpoints found;
  answered_.expires_at(canopen::TimePoint::max());
  const LookUp asked(executor_, entry_.host, entry_.port, [&](const error_code& why, Endpoints endpoints) {
    failed = why;
    found = std::move(endpoints);
    answered_.cancel();
  });
  error_code ignored;
  co_await answered_.async_wait(redirect_error(use_awaitable, ignored));
  if (failed && !closed_) {
    warn_once(failed);
  }
  co_return std::move(found);
}

bool Listener::open(const Endpoints& endpoints) {
  error_code worst;
  error_code of_no_use;
  for (const tcp::endpoint& at : endpoints) {
    if (std::ranges::count(sockets_, at, &Socket::asked_for) != 0) {
      continue;
    }
    error_code failed;
    std::optional<tcp::acceptor> acceptor = bind(at, failed);
    if (acceptor) {
      serve(at, std::move(*acceptor));
    } else {
      (is_of_no_use(failed) ? of_no_use : worst) = failed;
    }
  }
  if (!worst && sockets_.empty()) {
    worst = of_no_use;
  }
  if (worst) {
    warn_once(worst);
    return false;
  }
  owner_.log.own_info(name_, "listening");
  return true;
}

std::optional<tcp::acceptor> Listener::bind(const tcp::endpoint& at, error_code& failed) {
  tcp::acceptor acceptor(executor_);
  acceptor.open(at.protocol(), failed);
  if (!failed) {
    acceptor.set_option(tcp::acceptor::reuse_address(true), failed);
  }
  if (!failed && at.address().is_v6()) {
    acceptor.set_option(boost::asio::ip::v6_only(true), failed);
  }
  if (!failed) {
    acceptor.bind(at, failed);
  }
  if (is_absent(failed) && numeric()) {
    // Of both kinds of address (ip(7)): taken now, served from the moment on at which the machine gets it.
    const int on = 1;
    ::setsockopt(acceptor.native_handle(), IPPROTO_IP, IP_FREEBIND, &on, sizeof on);
    acceptor.bind(at, failed);
    if (!failed) {
      owner_.log.own_warn(name_,
                          "this machine does not have the address (`ip address` shows which it has); it is served "
                          "as soon as it does");
    }
  }
  if (!failed) {
    acceptor.listen(boost::asio::socket_base::max_listen_connections, failed);
  }
  return failed ? std::nullopt : std::optional(std::move(acceptor));
}

void Listener::serve(const tcp::endpoint& asked_for, tcp::acceptor acceptor) {
  sockets_.push_back({asked_for, std::move(acceptor), canopen::Timer(executor_)});
  owner_.spawn(accept_from(sockets_.back()));
}

awaitable<void> Listener::accept_from(Socket& socket) {
  while (!closed_) {
    error_code failed;
    tcp::socket client = co_await socket.acceptor.async_accept(redirect_error(use_awaitable, failed));
    if (!failed) {
      owner_.spare.keep();
      owner_.take(std::move(client), false);
      continue;
    }
    if (closed_ || failed == boost::asio::error::connection_aborted) {
      continue;
    }
    if (has_no_descriptor(failed)) {
      owner_.log.own_warn(name_, "no descriptor is left (" + failed.message() +
                                     "): who connects is refused, but for those who may take another's place");
      if (take_last(socket)) {
        continue;
      }
    } else {
      const bool no_memory = failed == boost::asio::error::no_buffer_space || failed == boost::asio::error::no_memory;
      owner_.log.own_warn(name_, "cannot take a connection: " + failed.message() +
                                     (no_memory ? "; who connects waits until memory is free" : "; it is tried again"));
    }
    socket.pause.expires_after(kAcceptPause);
    co_await socket.pause.async_wait(redirect_error(use_awaitable, failed));
  }
}

bool Listener::take_last(Socket& socket) {
  if (!owner_.spare.release()) {
    owner_.spare.keep();
    return false;
  }
  error_code failed;
  socket.acceptor.non_blocking(true, failed);
  tcp::socket client = socket.acceptor.accept(failed);
  const bool taken = !failed;
  if (taken) {
    owner_.take(std::move(client), true);
  }
  owner_.spare.keep();
  return taken;
}

void Listener::warn_once(const error_code& cause) {
  std::string text =
      "cannot listen: " + cause.message() + "; " + remedy(cause, entry_, owner_.may_be_passed) + ". It is tried again";
  if (text != told_) {
    owner_.log.own_warn(name_, text);
    told_ = std::move(text);
  }
}

}  // namespace net
