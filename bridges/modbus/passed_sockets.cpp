#include "bridges/modbus/passed_sockets.h"

#include <fcntl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <boost/system/error_code.hpp>
#include <sstream>
#include <string>
#include <utility>

namespace modbus {
namespace {

using boost::asio::ip::tcp;
using boost::system::error_code;

// -1 where it has none, or is no socket.
int option_of(int descriptor, int option) {
  int value = -1;
  socklen_t size = sizeof value;
  return ::getsockopt(descriptor, SOL_SOCKET, option, &value, &size) == 0 ? value : -1;
}

std::optional<tcp> listens_to(int descriptor) {
  if (option_of(descriptor, SO_TYPE) != SOCK_STREAM || option_of(descriptor, SO_ACCEPTCONN) != 1) {
    return std::nullopt;
  }
  const int family = option_of(descriptor, SO_DOMAIN);
  return family == AF_INET ? std::optional(tcp::v4()) : family == AF_INET6 ? std::optional(tcp::v6()) : std::nullopt;
}

std::string text_of(const tcp::acceptor& acceptor) {
  error_code failed;
  std::ostringstream text;
  text << acceptor.local_endpoint(failed);
  return text.str();
}

}  // namespace

std::vector<int> duplicates_of(std::span<const int> descriptors) {
  std::vector<int> duplicates;
  for (const int descriptor : descriptors) {
    if (const int duplicate = ::fcntl(descriptor, F_DUPFD_CLOEXEC, 0); duplicate >= 0) {
      ::listen(duplicate, SOMAXCONN);
      duplicates.push_back(duplicate);
    }
  }
  return duplicates;
}

void stop_listening(int descriptor) {
  ::shutdown(descriptor, SHUT_RD);
}

PassedSockets::PassedSockets(const boost::asio::any_io_executor& executor, std::span<const int> descriptors,
                             net::ConnectionLog& log)
    : log_(log) {
  for (const int descriptor : descriptors) {
    const std::optional<tcp> protocol = listens_to(descriptor);
    error_code failed;
    tcp::acceptor acceptor(executor);
    if (protocol) {
      acceptor.assign(*protocol, descriptor, failed);
    }
    if (protocol && !failed) {
      acceptors_.push_back(std::move(acceptor));
    } else {
      log_.own_warn("descriptor " + std::to_string(descriptor),
                    "the service manager passed it, but it is no listening TCP socket, so it is closed; [Socket] needs "
                    "ListenStream= with an address and a port");
      ::close(descriptor);
    }
  }
}

std::optional<tcp::acceptor> PassedSockets::take(const tcp::endpoint& at) {
  const auto found = std::ranges::find_if(acceptors_, [&at](const tcp::acceptor& acceptor) {
    error_code failed;
    const tcp::endpoint bound = acceptor.local_endpoint(failed);
    return !failed && bound == at;
  });
  if (found == acceptors_.end()) {
    return std::nullopt;
  }
  std::optional<tcp::acceptor> taken(std::move(*found));
  acceptors_.erase(found);
  return taken;
}

void PassedSockets::close_rest() {
  for (tcp::acceptor& acceptor : acceptors_) {
    stop_listening(acceptor.native_handle());
    log_.own_warn(
        text_of(acceptor),
        "the service manager passed a socket for it, but [modbus] listen has no entry with just this address and "
        "port, so it is closed; add the entry, or mend ListenStream= of the socket unit (a port alone is [::] and, "
        "without BindIPv6Only=ipv6-only, keeps 0.0.0.0 from being bound: write ListenStream=0.0.0.0:PORT)");
  }
  acceptors_.clear();
}

}  // namespace modbus
