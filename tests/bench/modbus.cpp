#include <fmt/format.h>
#include <pthread.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <ctime>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "tests/bench/modbus_ceiling.h"
#include "tests/bench/modbus_load.h"
#include "tests/bench/parts.h"
#include "tests/bench/rates.h"
#include "tests/bench/site.h"

namespace bench {
namespace {

// Many and short ones, in turn: what else the machine does meets both sides alike.
constexpr int kModbusRounds = 25;
constexpr std::chrono::milliseconds kModbusRound{250};
constexpr double kLeastRatio = 0.8;

/// Processor time that the thread has used, in µs.
double used_by(std::thread& thread) {
  clockid_t clock{};
  timespec time{};
  if (pthread_getcpuclockid(thread.native_handle(), &clock) != 0 || clock_gettime(clock, &time) != 0) {
    throw std::runtime_error("the clock of a thread cannot be read");
  }
  return static_cast<double>(time.tv_sec) * 1e6 + static_cast<double>(time.tv_nsec) / 1e3;
}

/// One of the two servers, and what its rounds came to.
struct Side {
  std::uint16_t port;
  std::uint8_t unit;
  std::thread& thread;
  std::vector<double> p50{};  ///< In µs, these too.
  std::vector<double> p99{};
  std::vector<double> used{};  ///< By one request.
  double slowest = 0;

  /// Requests per second.
  double round(int clients) {
    const double before = used_by(thread);
    const ModbusTimes times = ask({.port = port, .unit = unit, .clients = clients, .time = kModbusRound});
    used.push_back((used_by(thread) - before) / static_cast<double>(times.took.size()));
    p50.push_back(times.within(0.5));
    p99.push_back(times.within(0.99));
    slowest = std::max<double>(slowest, times.took.back());
    return times.per_second;
  }
  void tell(const char* name) const {
    fmt::print("  {:<8} µs: p50 {:.0f}, p99 {:.0f}, max {:.0f}; processor {:.1f} a request\n", name, median(p50),
               median(p99), slowest, median(used));
  }
};

}  // namespace

void modbus() {
  const std::uint16_t bare_port = free_port();
  BareModbusServer bare(bare_port);
  const std::uint16_t gateway_port = free_port();
  config::Model model = demo_model(gateway_port, 0);
  model.modbus->max_clients = 500;  // and one address has half of them
  SiteInThread site(std::move(model));
  if (!site.wait_online()) {
    throw std::runtime_error("the simulated drives did not come online");
  }
  std::string missed;
  for (const int clients : {1, 8, 32, 200}) {
    Side ceiling{.port = bare_port, .unit = 1, .thread = bare.thread()};
    Side gateway{.port = gateway_port, .unit = *site.model().drives.front().unit, .thread = site.thread()};
    const Comparison rates = compare(
        fmt::format("Modbus, function 3, 10 registers, {} client{}", clients, clients == 1 ? "" : "s"), "requests/s",
        kModbusRounds, [&] { return ceiling.round(clients); }, [&] { return gateway.round(clients); });
    print(rates);
    ceiling.tell("ceiling");
    gateway.tell("gateway");
    std::fflush(stdout);
    const double ratio = median_ratio(rates);
    if (ratio < kLeastRatio) {
      missed += fmt::format(" {:.2f} with {} clients;", ratio, clients);
    }
  }
  if (!missed.empty()) {
    throw std::runtime_error(fmt::format("less than {} of a bare server:{}", kLeastRatio, missed));
  }
}

}  // namespace bench
