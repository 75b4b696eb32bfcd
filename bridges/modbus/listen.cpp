#include "bridges/modbus/listen.h"

#include <boost/asio/ip/v6_only.hpp>
#include <boost/system/error_code.hpp>
#include <optional>
#include <stdexcept>

namespace modbus {
namespace {

using boost::asio::ip::tcp;
using boost::system::error_code;

constexpr unsigned kFirstOrdinaryPort = 1024;

std::string remedy(const error_code& cause, const config::Endpoint& endpoint) {
  if (cause == boost::asio::error::address_in_use) {
    return "another program listens there (`ss -ltnp` shows which): stop it, or take another port";
  }
  if (cause == boost::asio::error::access_denied && endpoint.port < kFirstOrdinaryPort) {
    return "ports below 1024 need the capability CAP_NET_BIND_SERVICE, which the systemd unit gives: start it that "
           "way, or take a port from 1024 on";
  }
  if (cause == boost::asio::error::address_family_not_supported) {
    return "this system does not have that kind of address: leave the entry out";
  }
  return "this machine must have the address (`ip address` shows which it has): take one of these, or 0.0.0.0 or [::] "
         "for all";
}

[[noreturn]] void refuse(const config::Endpoint& endpoint, const error_code& cause) {
  throw std::runtime_error("[modbus] listen: cannot listen on " + to_string(endpoint) + ": " + cause.message() + "; " +
                           remedy(cause, endpoint));
}

std::optional<tcp::acceptor> open(const boost::asio::any_io_executor& executor, const tcp::endpoint& at,
                                  error_code& failed) {
  tcp::acceptor acceptor(executor);
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
  if (!failed) {
    acceptor.listen(boost::asio::socket_base::max_listen_connections, failed);
  }
  return failed ? std::nullopt : std::optional(std::move(acceptor));
}

// A name may stand for an address of a kind that this machine does not have (localhost without IPv6).
bool is_absent_address(const error_code& cause) {
  return cause == boost::asio::error::address_family_not_supported ||
         cause == error_code(EADDRNOTAVAIL, boost::system::system_category());
}

}  // namespace

std::string to_string(const config::Endpoint& endpoint) {
  const bool is_v6 = endpoint.host.find(':') != std::string::npos;
  return (is_v6 ? "[" + endpoint.host + "]" : endpoint.host) + ":" + std::to_string(endpoint.port);
}

std::vector<tcp::acceptor> open_listeners(boost::asio::any_io_executor executor, const config::Endpoint& endpoint) {
  error_code failed;
  tcp::resolver resolver(executor);
  const auto found = resolver.resolve(endpoint.host, std::to_string(endpoint.port), tcp::resolver::passive, failed);
  if (failed) {
    refuse(endpoint, failed);
  }
  std::vector<tcp::acceptor> acceptors;
  error_code absent;
  for (const auto& entry : found) {
    std::optional<tcp::acceptor> acceptor = open(executor, entry.endpoint(), failed);
    if (acceptor) {
      acceptors.push_back(std::move(*acceptor));
    } else if (is_absent_address(failed)) {
      absent = failed;
    } else {
      refuse(endpoint, failed);
    }
  }
  if (acceptors.empty()) {
    refuse(endpoint, absent);
  }
  return acceptors;
}

}  // namespace modbus
