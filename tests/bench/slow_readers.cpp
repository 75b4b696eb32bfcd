#include "tests/bench/slow_readers.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <stdexcept>
#include <utility>

namespace bench {
namespace {

int small_socket(int family) {
  const int descriptor = socket(family, SOCK_STREAM | SOCK_CLOEXEC, 0);
  const int room = 2048;
  setsockopt(descriptor, SOL_SOCKET, SO_RCVBUF, &room, sizeof room);
  return descriptor;
}

template <class Address>
int ask(int descriptor, const Address& server, std::string_view request) {
  if (connect(descriptor, reinterpret_cast<const sockaddr*>(&server), sizeof server) != 0 ||
      send(descriptor, request.data(), request.size(), MSG_NOSIGNAL) != static_cast<ssize_t>(request.size()) ||
      fcntl(descriptor, F_SETFL, O_NONBLOCK) != 0) {
    close(descriptor);
    throw std::runtime_error("a reader cannot connect");
  }
  return descriptor;
}

}  // namespace

int slow_http_reader(std::uint16_t port, std::string_view request, int number) {
  const int descriptor = small_socket(AF_INET);
  sockaddr_in own{};
  own.sin_family = AF_INET;
  own.sin_addr.s_addr = htonl(INADDR_LOOPBACK + 1 + static_cast<std::uint32_t>(number % 5));
  if (bind(descriptor, reinterpret_cast<const sockaddr*>(&own), sizeof own) != 0) {
    close(descriptor);
    throw std::runtime_error("a reader gets no address");
  }
  sockaddr_in server{};
  server.sin_family = AF_INET;
  server.sin_port = htons(port);
  server.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  return ask(descriptor, server, request);
}

int slow_control_reader(const std::string& path, std::string_view request) {
  sockaddr_un server{};
  server.sun_family = AF_UNIX;
  path.copy(server.sun_path, sizeof server.sun_path - 1);
  return ask(small_socket(AF_UNIX), server, request);
}

SlowReaders::SlowReaders(std::vector<int> descriptors) : descriptors_(std::move(descriptors)) {
  thread_ = std::thread([this] {
    while (!stop_) {
      take();
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
    }
  });
}

SlowReaders::~SlowReaders() {
  stop_ = true;
  thread_.join();
  for (const int descriptor : descriptors_) {
    close(descriptor);
  }
}

void SlowReaders::take() {
  int streaming = 0;
  for (const int descriptor : descriptors_) {
    std::array<char, 128> some{};
    const ssize_t count = recv(descriptor, some.data(), some.size(), 0);
    const std::string_view text(some.data(), static_cast<std::size_t>(std::max<ssize_t>(count, 0)));
    const bool refused = text.starts_with("HTTP/1.1 503") || text.find("\"ok\":false") != text.npos;
    const bool ended = count == 0 || (count < 0 && errno != EAGAIN) || refused;
    streaming += ended ? 0 : 1;
  }
  streaming_ = streaming;
}

}  // namespace bench
