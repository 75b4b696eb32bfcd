// What many slow readers of the live stream and of the trace cost those who read by Modbus, beside a full bus.

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <functional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include "daemon/temporary_directory.h"
#include "tests/bench/bus_load.h"
#include "tests/bench/parts.h"
#include "tests/bench/round_trips.h"
#include "tests/bench/site.h"
#include "tests/bench/slow_readers.h"

namespace bench {
namespace {

using std::chrono::milliseconds;

constexpr int kReaderRounds = 5;
// The least of several windows: whatever else the machine does stops the gateway now and then for longer than a request
// takes. In each window every reader is told twice.
constexpr int kWindows = 8;
constexpr milliseconds kWindow{500};
constexpr unsigned kFramesOfFullBus = 1900;  ///< A second: 8 bytes each at 250 kbit/s, some 131 bits a frame.
constexpr double kMostRatio = 2.0;
/// In MB: 64 kB of waiting lines and some buffers for each of 192, and the frames that are kept.
constexpr double kMostMemory = 40.0;

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

struct Crowd {
  std::string_view what;
  int readers;
  int served;  ///< There is room for so many; the others are refused.
  std::function<int(int)> connect;
};

/// Rounds without and with the crowd, in turn, beside a full bus. Throws where a frame is missing, or Modbus suffers.
void measure(SiteInThread& site, BusLoad& load, RoundTripClient& client, const Crowd& crowd) {
  RoundTrips times{.what = fmt::format("{}, Modbus reads", crowd.what), .before = {}, .during = {}};
  double least_memory = 0;
  double most_memory = 0;
  for (int round = 0; round <= kReaderRounds; ++round) {
    const double before = least_p99(client);
    least_memory = round == 1 ? resident() : least_memory;
    std::vector<int> descriptors;
    for (int number = 0; number < crowd.readers; ++number) {
      descriptors.push_back(crowd.connect(number));
    }
    const SlowReaders slow(std::move(descriptors));
    std::this_thread::sleep_for(milliseconds(1500));  // each has its backlog
    const std::uint64_t received = site.frames_received();
    const std::uint64_t sent = load.sent();
    const double during = least_p99(client);
    expect_all_frames(site, load, received, sent);
    if (slow.streaming() < crowd.served) {
      throw std::runtime_error(fmt::format("{}: {} are served", crowd.what, slow.streaming()));
    }
    most_memory = std::max(most_memory, resident());
    if (round > 0) {
      times.before.push_back(before);
      times.during.push_back(during);
    }
  }
  const double ratio = print(times);
  const double memory = most_memory - least_memory;
  fmt::print("{:<52} {:.1f} MB more than without\n", fmt::format("{}, memory", crowd.what), memory);
  if (ratio > kMostRatio) {
    throw std::runtime_error(fmt::format("{} delay Modbus: {:.2f} > {}", crowd.what, ratio, kMostRatio));
  }
  if (memory > kMostMemory) {
    throw std::runtime_error(fmt::format("{} take {:.1f} MB > {}", crowd.what, memory, kMostMemory));
  }
}

}  // namespace

void readers() {
  const gateway::TemporaryDirectory folder;
  const std::uint16_t modbus_port = free_port();
  config::Model model = demo_model(modbus_port, 0);
  model.gateway.control = folder.path() / "control";
  model.http.emplace().listen = {"127.0.0.1", free_port()};
  const std::uint16_t http_port = model.http->listen.port;
  SiteInThread site(std::move(model));
  if (!site.wait_online()) {
    throw std::runtime_error("the simulated drives did not come online");
  }
  const auto get = [&](std::string_view target) {
    return [http_port, request = fmt::format("GET {} HTTP/1.1\r\nHost: localhost\r\n\r\n", target)](int number) {
      return slow_http_reader(http_port, request, number);
    };
  };
  RoundTripClient client(modbus_port, *site.model().drives.front().unit);
  BusLoad load(site, kFramesOfFullBus, changing_tpdo);
  measure(site, load, client, {"200 slow readers of /api/live", 200, 192, get("/api/live")});
  measure(site, load, client, {"200 slow readers of /api/trace", 200, 192, get("/api/trace")});
  measure(site, load, client,
          {"32 slow readers of the socket's trace", 32, 32,
           [&](int) { return slow_control_reader(site.model().gateway.control, "{\"id\":1,\"op\":\"trace\"}\n"); }});
}

}  // namespace bench
