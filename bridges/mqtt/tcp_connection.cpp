#include "bridges/mqtt/tcp_connection.h"

#include <netdb.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <iterator>
#include <memory>

namespace mqtt {

using std::chrono::steady_clock;

TcpConnection::~TcpConnection() {
  if (descriptor >= 0) {
    close(descriptor);
  }
}

bool wait_for(const TcpConnection& connection, short events, steady_clock::time_point end) {
  const auto left = std::chrono::ceil<std::chrono::milliseconds>(end - steady_clock::now()).count();
  pollfd wait{connection.descriptor, events, 0};
  return left > 0 && poll(&wait, 1, static_cast<int>(left)) > 0;
}

TcpConnection connect_to(const std::vector<std::string>& addresses, std::uint16_t port, steady_clock::time_point end) {
  std::vector<std::string> in_order;
  for (const bool v6 : {false, true}) {
    std::ranges::copy_if(addresses, std::back_inserter(in_order),
                         [v6](const std::string& each) { return (each.find(':') != std::string::npos) == v6; });
  }
  addrinfo hints{};
  hints.ai_family = AF_UNSPEC;
  hints.ai_socktype = SOCK_STREAM;
  hints.ai_flags = AI_NUMERICHOST | AI_NUMERICSERV;
  auto left = static_cast<steady_clock::rep>(addresses.size());
  for (const std::string& address : in_order) {
    const steady_clock::time_point share = steady_clock::now() + (end - steady_clock::now()) / left--;
    addrinfo* found = nullptr;
    if (getaddrinfo(address.c_str(), std::to_string(port).c_str(), &hints, &found) != 0) {
      continue;
    }
    const std::unique_ptr<addrinfo, decltype(&freeaddrinfo)> list(found, &freeaddrinfo);
    TcpConnection made(socket(list->ai_family, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
    if (made.descriptor < 0) {
      continue;
    }
    int failed = connect(made.descriptor, list->ai_addr, list->ai_addrlen) == 0 ? 0 : errno;
    socklen_t size = sizeof(failed);
    if (failed == EINPROGRESS && wait_for(made, POLLOUT, share)) {
      getsockopt(made.descriptor, SOL_SOCKET, SO_ERROR, &failed, &size);
    }
    if (failed == 0) {
      return made;
    }
  }
  return TcpConnection();
}

}  // namespace mqtt
