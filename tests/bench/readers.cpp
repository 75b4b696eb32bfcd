// What many slow readers of the live stream cost those who read by Modbus, beside a full bus.

#include <arpa/inet.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <fstream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "tests/bench/bus_load.h"
#include "tests/bench/parts.h"
#include "tests/bench/round_trips.h"
#include "tests/bench/site.h"

namespace bench {
namespace {

using std::chrono::milliseconds;

constexpr int kReaderRounds = 5;
// The least of several windows: whatever else the machine does stops the gateway now and then for longer than a request
// takes. In each window every reader is told twice.
constexpr int kWindows = 8;
constexpr milliseconds kWindow{500};
constexpr int kReaders = 200;
constexpr int kServed = 192;                 ///< There is room for so many; the others are told 503.
constexpr unsigned kFramesOfFullBus = 1900;  ///< A second: 8 bytes each at 250 kbit/s, some 131 bits a frame.
constexpr double kMostRatio = 2.0;

/// Clients that ask for the live stream and take little of it: 128 bytes each, ten times a second.
class SlowReaders {
 public:
  explicit SlowReaders(std::uint16_t port) {
    for (int i = 0; i < kReaders; ++i) {
      descriptors_.push_back(connect_to(port, 2 + i % 5));  // no address has more than 64
    }
    thread_ = std::thread([this] {
      while (!stop_) {
        take();
        std::this_thread::sleep_for(milliseconds(100));
      }
    });
  }
  ~SlowReaders() {
    stop_ = true;
    thread_.join();
    for (const int descriptor : descriptors_) {
      close(descriptor);
    }
  }
  SlowReaders(const SlowReaders&) = delete;
  SlowReaders& operator=(const SlowReaders&) = delete;

  /// Of those that the server has not disconnected.
  [[nodiscard]] int streaming() const noexcept { return streaming_; }

 private:
  static int connect_to(std::uint16_t port, int from) {
    const int descriptor = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    const int room = 2048;
    setsockopt(descriptor, SOL_SOCKET, SO_RCVBUF, &room, sizeof room);
    sockaddr_in own{};
    own.sin_family = AF_INET;
    own.sin_addr.s_addr = htonl(INADDR_LOOPBACK - 1 + static_cast<std::uint32_t>(from));
    sockaddr_in server{};
    server.sin_family = AF_INET;
    server.sin_port = htons(port);
    server.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    constexpr std::string_view kRequest = "GET /api/live HTTP/1.1\r\nHost: localhost\r\n\r\n";
    if (bind(descriptor, reinterpret_cast<const sockaddr*>(&own), sizeof own) != 0 ||
        connect(descriptor, reinterpret_cast<const sockaddr*>(&server), sizeof server) != 0 ||
        send(descriptor, kRequest.data(), kRequest.size(), MSG_NOSIGNAL) != static_cast<ssize_t>(kRequest.size()) ||
        fcntl(descriptor, F_SETFL, O_NONBLOCK) != 0) {
      throw std::runtime_error("a reader cannot connect");
    }
    return descriptor;
  }

  void take() {
    int streaming = 0;
    for (const int descriptor : descriptors_) {
      std::array<char, 128> some{};
      const ssize_t count = recv(descriptor, some.data(), some.size(), 0);
      const std::string_view text(some.data(), static_cast<std::size_t>(std::max<ssize_t>(count, 0)));
      const bool ended = count == 0 || (count < 0 && errno != EAGAIN) || text.starts_with("HTTP/1.1 503");
      streaming += ended ? 0 : 1;
    }
    streaming_ = streaming;
  }

  std::vector<int> descriptors_;
  std::atomic<int> streaming_ = 0;
  std::atomic<bool> stop_ = false;
  std::thread thread_;
};

/// Of the gateway and of what measures it, in MB.
double resident() {
  std::ifstream file("/proc/self/statm");
  double pages = 0;
  file >> pages >> pages;
  return pages * static_cast<double>(sysconf(_SC_PAGESIZE)) / 1e6;
}

// fan1 and pump1 in turn, each with another current than before: every frame changes what readers are told.
canopen::Frame changing_tpdo(std::uint64_t number) {
  canopen::Frame frame;
  frame.id = number % 2 == 0 ? 0x183 : 0x185;
  frame.size = 8;
  frame.data = {0x80, 0, static_cast<std::uint8_t>(number), static_cast<std::uint8_t>(number >> 8), 1, 0, 2, 0};
  return frame;
}

double least_p99(RoundTripClient& client) {
  double least = 0;
  for (int window = 0; window < kWindows; ++window) {
    const double one = p99([&client] { client.read(); }, kWindow);
    least = window == 0 ? one : std::min(least, one);
  }
  return least;
}

void expect_all_frames(SiteInThread& site, BusLoad& load, std::uint64_t received_before, std::uint64_t sent_before) {
  const std::uint64_t sent = load.sent() - sent_before;
  const std::uint64_t received = site.frames_received() - received_before;
  if (received < sent) {
    throw std::runtime_error(fmt::format("of {} frames {} were received", sent, received));
  }
  if (sent < kFramesOfFullBus * kWindows * kWindow / std::chrono::seconds(1) * 9 / 10) {
    throw std::runtime_error(fmt::format("the bus was not full: {} frames", sent));
  }
}

}  // namespace

void readers() {
  const std::uint16_t modbus_port = free_port();
  config::Model model = demo_model(modbus_port, 0);
  model.http.emplace().listen = {"127.0.0.1", free_port()};
  SiteInThread site(std::move(model));
  if (!site.wait_online()) {
    throw std::runtime_error("the simulated drives did not come online");
  }
  RoundTripClient client(modbus_port, *site.model().drives.front().unit);
  RoundTrips times{.what = "200 slow readers of /api/live, Modbus reads", .before = {}, .during = {}};
  BusLoad load(site, kFramesOfFullBus, changing_tpdo);
  double least_memory = 0;
  double most_memory = 0;
  for (int round = 0; round <= kReaderRounds; ++round) {
    const double before = least_p99(client);
    least_memory = round == 1 ? resident() : least_memory;
    const SlowReaders slow(site.model().http->listen.port);
    std::this_thread::sleep_for(milliseconds(1500));  // each has its backlog
    const std::uint64_t received = site.frames_received();
    const std::uint64_t sent = load.sent();
    const double during = least_p99(client);
    expect_all_frames(site, load, received, sent);
    if (slow.streaming() < kServed) {
      throw std::runtime_error(fmt::format("{} readers are served", slow.streaming()));
    }
    most_memory = std::max(most_memory, resident());
    if (round > 0) {
      times.before.push_back(before);
      times.during.push_back(during);
    }
  }
  const double ratio = print(times);
  fmt::print("{:<44} {:.1f} MB more than without\n", "200 slow readers of /api/live, memory",
             most_memory - least_memory);
  if (ratio > kMostRatio) {
    throw std::runtime_error(fmt::format("slow readers delay Modbus: {:.2f} > {}", ratio, kMostRatio));
  }
}

}  // namespace bench
