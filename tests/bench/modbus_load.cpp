#include "tests/bench/modbus_load.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/epoll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <stdexcept>
#include <vector>

namespace bench {
namespace {

constexpr std::size_t kAnswerSize = 9 + 20;  // MBAP header, function, byte count, ten registers.

class Connection {
 public:
  Connection(std::uint16_t port, std::uint8_t unit)
      : descriptor_(socket(AF_INET, SOCK_STREAM, 0)), request_{0, 1, 0, 0, 0, 6, unit, 3, 0, 0, 0, 10} {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    address.sin_port = htons(port);
    const int on = 1;
    setsockopt(descriptor_, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
    if (connect(descriptor_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
      throw std::runtime_error("cannot connect to the Modbus server");
    }
  }
  ~Connection() { close(descriptor_); }
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  [[nodiscard]] int descriptor() const noexcept { return descriptor_; }

  void ask() {
    if (write(descriptor_, request_.data(), request_.size()) != static_cast<ssize_t>(request_.size())) {
      throw std::runtime_error("a request could not be sent");
    }
    received_ = 0;
  }

  /// True when the answer is complete.
  bool take() {
    std::array<std::uint8_t, 256> answer{};
    const ssize_t count = read(descriptor_, answer.data(), answer.size());
    if (count <= 0 || (received_ == 0 && count >= 8 && answer[7] != 3)) {
      throw std::runtime_error("no normal answer to a read");
    }
    received_ += static_cast<std::size_t>(count);
    return received_ >= kAnswerSize;
  }

 private:
  int descriptor_;
  std::array<std::uint8_t, 12> request_;
  std::size_t received_ = 0;
};

}  // namespace

double requests_per_second(const ModbusLoad& load) {
  const int poll = epoll_create1(0);
  std::vector<std::unique_ptr<Connection>> connections;
  for (int i = 0; i < load.clients; ++i) {
    connections.push_back(std::make_unique<Connection>(load.port, load.unit));
    epoll_event event{};
    event.events = EPOLLIN;
    event.data.ptr = connections.back().get();
    epoll_ctl(poll, EPOLL_CTL_ADD, connections.back()->descriptor(), &event);
    connections.back()->ask();
  }
  const auto begin = std::chrono::steady_clock::now();
  auto now = begin;
  std::uint64_t answers = 0;
  std::array<epoll_event, 16> events{};
  while (now - begin < load.time) {
    const int ready = epoll_wait(poll, events.data(), static_cast<int>(events.size()), 1000);
    if (ready <= 0) {
      throw std::runtime_error("no answer within a second");
    }
    for (int i = 0; i < ready; ++i) {
      auto* const connection = static_cast<Connection*>(events[static_cast<std::size_t>(i)].data.ptr);
      if (connection->take()) {
        ++answers;
        connection->ask();
      }
    }
    now = std::chrono::steady_clock::now();
  }
  close(poll);
  return static_cast<double>(answers) / std::chrono::duration<double>(now - begin).count();
}

}  // namespace bench
