#include "tests/unit/daemon/notify_socket.h"

#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>

#include <array>
#include <cstddef>
#include <stdexcept>

namespace gateway::test {

NotifySocket::NotifySocket() : socket_(::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0)) {
  // Bound by its family alone it gets a free abstract name, which begins with a zero byte (unix(7)).
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  // The sockets API takes every kind of address by this one type.
  auto* const generic = reinterpret_cast<sockaddr*>(&address);
  socklen_t length = sizeof address;
  if (::bind(socket_.get(), generic, sizeof address.sun_family) != 0 ||
      ::getsockname(socket_.get(), generic, &length) != 0) {
    throw std::runtime_error("no socket for notifications");
  }
  const std::size_t name_length = length - offsetof(sockaddr_un, sun_path);
  name_ = "@" + std::string(&address.sun_path[1], name_length - 1);
}

std::vector<std::string> NotifySocket::heard() {
  std::vector<std::string> messages;
  std::array<char, 4096> buffer{};
  for (;;) {
    const ssize_t length = ::recv(socket_.get(), buffer.data(), buffer.size(), 0);
    if (length < 0) {
      return messages;
    }
    messages.emplace_back(buffer.data(), static_cast<std::size_t>(length));
  }
}

std::optional<std::string> NotifySocket::next() {
  pollfd waiting{.fd = socket_.get(), .events = POLLIN, .revents = 0};
  std::array<char, 4096> buffer{};
  if (::poll(&waiting, 1, 10000) != 1) {
    return std::nullopt;
  }
  const ssize_t length = ::recv(socket_.get(), buffer.data(), buffer.size(), 0);
  return length < 0 ? std::nullopt : std::optional(std::string(buffer.data(), static_cast<std::size_t>(length)));
}

}  // namespace gateway::test
