#pragma once

#include <arpa/inet.h>
#include <netdb.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

namespace mqtt::test {

/// A port of loopback that takes connections and says nothing; what a client says first to it.
class FirstWords {
 public:
  /// Port 0: any.
  explicit FirstWords(const std::string& at = "127.0.0.1", std::uint16_t port = 0) {
    addrinfo hints{};
    hints.ai_socktype = SOCK_STREAM;
    hints.ai_flags = AI_NUMERICHOST | AI_NUMERICSERV;
    addrinfo* found = nullptr;
    if (getaddrinfo(at.c_str(), std::to_string(port).c_str(), &hints, &found) != 0) {
      throw std::runtime_error("no address " + at);
    }
    const std::unique_ptr<addrinfo, decltype(&freeaddrinfo)> list(found, &freeaddrinfo);
    server_ = socket(list->ai_family, SOCK_STREAM | SOCK_CLOEXEC, 0);
    socklen_t size = sizeof(address_);
    if (bind(server_, list->ai_addr, list->ai_addrlen) != 0 || listen(server_, 8) != 0 ||
        getsockname(server_, address(), &size) != 0) {
      close(server_);
      throw std::runtime_error("no port on loopback");
    }
  }
  ~FirstWords() {
    close(server_);
    for (const int each : waiting_) {
      close(each);
    }
  }
  FirstWords(const FirstWords&) = delete;
  FirstWords& operator=(const FirstWords&) = delete;

  /// The port's place is the same in an address of IPv6.
  [[nodiscard]] std::uint16_t port() const noexcept {
    return ntohs(reinterpret_cast<const sockaddr_in*>(&address_)->sin_port);
  }
  [[nodiscard]] bool has_client() const {
    pollfd wait{server_, POLLIN, 0};
    return poll(&wait, 1, 0) > 0;
  }
  /// Of the next client; empty where none comes within 10 s.
  [[nodiscard]] std::string hear() const {
    std::array<char, 2048> bytes{};
    pollfd wait{server_, POLLIN, 0};
    if (poll(&wait, 1, 10'000) <= 0) {
      return {};
    }
    const int client = accept4(server_, nullptr, nullptr, SOCK_CLOEXEC);
    const ssize_t length = recv(client, bytes.data(), bytes.size(), 0);
    close(client);
    return {bytes.data(), length > 0 ? static_cast<std::size_t>(length) : 0};
  }
  /// The next client, whose calls do not block, the caller's own; negative where none comes within 10 s.
  [[nodiscard]] int take() const {
    pollfd wait{server_, POLLIN, 0};
    return poll(&wait, 1, 10'000) > 0 ? accept4(server_, nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK) : -1;
  }
  /// Lets so many clients wait that Linux answers no further one.
  [[nodiscard]] bool fill() {
    for (int client = 0; client < 64; ++client) {
      waiting_.push_back(socket(address_.ss_family, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
      (void)connect(waiting_.back(), address(), sizeof(sockaddr_in));
      pollfd wait{waiting_.back(), POLLOUT, 0};
      if (poll(&wait, 1, 200) == 0) {
        return true;
      }
    }
    return false;
  }

 private:
  // The sockets API takes every kind of address by this one type.
  sockaddr* address() { return reinterpret_cast<sockaddr*>(&address_); }

  int server_ = -1;
  sockaddr_storage address_{};
  std::vector<int> waiting_;
};

}  // namespace mqtt::test
