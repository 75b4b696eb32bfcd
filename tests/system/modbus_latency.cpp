// modbus_latency PORT UNIT: libmodbus' client reads ten registers each 2 ms, in turn from the gateway and from a bare
// libmodbus server of this process, until SIGTERM. The machine may be busy now and then, which both suffer alike.
// Prints one line: how many answers of the gateway; within how many µs 99 % of them came, and the same of the bare
// server; the former in percent of the latter; and the slowest of the gateway in µs. An exception is an answer: a drive
// may be away. Status 1 where a read got none.

#include <modbus/modbus.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <stdexcept>
#include <thread>
#include <vector>

#include "tests/bench/modbus_ceiling.h"

namespace {

using Clock = std::chrono::steady_clock;
using Times = std::vector<std::int64_t>;  // in µs

constexpr std::chrono::milliseconds kPause{2};
constexpr std::uint32_t kAnswerWithin = 5;  // seconds
constexpr std::uint16_t kBarePort = 1599;

volatile std::sig_atomic_t stop = 0;

// libmodbus numbers the exceptions from here on, and behind them its own errors.
bool is_exception(int error) {
  return error > MODBUS_ENOBASE && error <= EMBXGTAR;
}

class PolledServer {
 public:
  PolledServer(int port, int unit) : server_(modbus_new_tcp("127.0.0.1", port), &modbus_free) {
    if (!server_ || modbus_set_slave(server_.get(), unit) != 0 || modbus_connect(server_.get()) != 0 ||
        modbus_set_response_timeout(server_.get(), kAnswerWithin, 0) != 0) {
      throw std::runtime_error("no connection");
    }
  }
  void read() {
    std::array<std::uint16_t, 10> registers{};
    const auto begun = Clock::now();
    if (modbus_read_registers(server_.get(), 0, registers.size(), registers.data()) != registers.size() &&
        !is_exception(errno)) {
      throw std::runtime_error(modbus_strerror(errno));
    }
    times_.push_back(std::chrono::duration_cast<std::chrono::microseconds>(Clock::now() - begun).count());
  }
  [[nodiscard]] Times& times() noexcept { return times_; }

 private:
  std::unique_ptr<modbus_t, decltype(&modbus_free)> server_;
  Times times_;
};

// What 99 % of them took at most.
std::int64_t p99(Times& times) {
  std::ranges::sort(times);
  return times.at(times.size() * 99 / 100);
}

void measure(PolledServer& gateway, PolledServer& bare) {
  for (auto due = Clock::now(); stop == 0; due += kPause) {
    // A read that took longer than the pause is followed at once, but none is made up for.
    due = std::max(due, Clock::now() - kPause);
    std::this_thread::sleep_until(due);
    gateway.read();
    bare.read();
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fputs("usage: modbus_latency PORT UNIT\n", stderr);
    return 2;
  }
  std::signal(SIGTERM, [](int) { stop = 1; });
  try {
    const bench::BareModbusServer server(kBarePort);
    PolledServer gateway(std::atoi(argv[1]), std::atoi(argv[2]));
    PolledServer bare(kBarePort, 1);
    measure(gateway, bare);
    const std::int64_t ours = p99(gateway.times());
    const std::int64_t ceiling = std::max<std::int64_t>(p99(bare.times()), 1);
    std::printf("%zu %lld %lld %lld %lld\n", gateway.times().size(), static_cast<long long>(ours),
                static_cast<long long>(ceiling), static_cast<long long>(ours * 100 / ceiling),
                static_cast<long long>(gateway.times().back()));
  } catch (const std::exception& error) {
    std::fprintf(stderr, "modbus_latency: %s\n", error.what());
    return 1;
  }
  return 0;
}
