#include "tests/bench/modbus_load.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/epoll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
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
    asked_ = std::chrono::steady_clock::now();
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
  [[nodiscard]] std::chrono::steady_clock::time_point asked() const noexcept { return asked_; }

 private:
  int descriptor_;
  std::array<std::uint8_t, 12> request_;
  std::size_t received_ = 0;
  std::chrono::steady_clock::time_point asked_;
};

}  // namespace

ModbusTimes ask(const ModbusLoad& load) {
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
  ModbusTimes times;
  std::array<epoll_event, 16> events{};
  while (now - begin < load.time) {
    const int ready = epoll_wait(poll, events.data(), static_cast<int>(events.size()), 1000);
    if (ready <= 0) {
      throw std::runtime_error("no answer within a second");
    }
    for (int i = 0; i < ready; ++i) {
      auto* const connection = static_cast<Connection*>(events[static_cast<std::size_t>(i)].data.ptr);
      if (connection->take()) {
        times.took.push_back(
            std::chrono::duration<float, std::micro>(std::chrono::steady_clock::now() - connection->asked()).count());
        connection->ask();
      }
    }
    now = std::chrono::steady_clock::now();
  }
  close(poll);
  times.per_second = static_cast<double>(times.took.size()) / std::chrono::duration<double>(now - begin).count();
  std::ranges::sort(times.took);
  return times;
}

}  // namespace bench
