#include "tests/unit/modbus/tcp_client.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <bit>
#include <cerrno>

namespace modbus_test {
namespace {

template <class Address>
bool connect_to(int socket, const Address& address) {
  return ::connect(socket, std::bit_cast<const sockaddr*>(&address), sizeof address) == 0;
}

std::size_t size_of(const Bytes& input) {
  return input.size() < 6 ? 6 : 6U + static_cast<std::size_t>(input[4] << 8 | input[5]);
}

}  // namespace

TcpClient::TcpClient(std::uint16_t port, const std::string& host, Buffers buffers, const std::string& from)
    : socket_(::socket(host.find(':') == std::string::npos ? AF_INET : AF_INET6, SOCK_STREAM, 0)) {
  if (buffers == Buffers::small) {
    const int bytes = 4096;
    ::setsockopt(socket_, SOL_SOCKET, SO_RCVBUF, &bytes, sizeof bytes);
    ::setsockopt(socket_, SOL_SOCKET, SO_SNDBUF, &bytes, sizeof bytes);
  }
  if (!from.empty()) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    ::inet_pton(AF_INET, from.c_str(), &address.sin_addr);
    ::bind(socket_, std::bit_cast<const sockaddr*>(&address), sizeof address);
  }
  if (host.find(':') == std::string::npos) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(port);
    ::inet_pton(AF_INET, host.c_str(), &address.sin_addr);
    connected_ = connect_to(socket_, address);
  } else {
    sockaddr_in6 address{};
    address.sin6_family = AF_INET6;
    address.sin6_port = htons(port);
    ::inet_pton(AF_INET6, host.c_str(), &address.sin6_addr);
    connected_ = connect_to(socket_, address);
  }
  ::fcntl(socket_, F_SETFL, O_NONBLOCK);
  const int on = 1;
  ::setsockopt(socket_, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
}

TcpClient::~TcpClient() {
  ::close(socket_);
}

std::size_t TcpClient::send(std::span<const std::uint8_t> bytes) {
  const ssize_t count = ::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
  return count > 0 ? static_cast<std::size_t>(count) : 0;
}

void TcpClient::finish() {
  ::shutdown(socket_, SHUT_WR);
}

void TcpClient::receive() {
  std::array<std::uint8_t, 65536> chunk{};
  const ssize_t count = ::recv(socket_, chunk.data(), chunk.size(), 0);
  if (count > 0) {
    input_.insert(input_.end(), chunk.begin(), chunk.begin() + count);
  } else if (count == 0 || (errno != EAGAIN && errno != EWOULDBLOCK)) {
    closed_ = true;
  }
}

bool TcpClient::has_frame() const {
  return input_.size() >= 6 && input_.size() >= size_of(input_);
}

Bytes TcpClient::take_frame() {
  const auto end = input_.begin() + static_cast<std::ptrdiff_t>(size_of(input_));
  Bytes taken(input_.begin(), end);
  input_.erase(input_.begin(), end);
  return taken;
}

}  // namespace modbus_test
