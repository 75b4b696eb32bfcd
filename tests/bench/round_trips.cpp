#include "tests/bench/round_trips.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <stdexcept>

#include "tests/bench/rates.h"

namespace bench {

using std::chrono::steady_clock;

RoundTripClient::RoundTripClient(std::uint16_t port, std::uint8_t unit)
    : context_(modbus_new_tcp("127.0.0.1", port), modbus_free) {
  if (!context_ || modbus_set_slave(context_.get(), unit) != 0 || modbus_connect(context_.get()) != 0) {
    throw std::runtime_error("cannot connect to the Modbus server");
  }
}

RoundTripClient::~RoundTripClient() {
  modbus_close(context_.get());
}

void RoundTripClient::read() {
  std::array<std::uint16_t, 10> words{};
  if (modbus_read_registers(context_.get(), 1000, 10, words.data()) != 10) {
    throw std::runtime_error("no normal answer to a read");
  }
}

void RoundTripClient::command() {
  if (modbus_write_register(context_.get(), 101, static_cast<std::uint16_t>(1000 + ++commands_ % 1000)) != 1) {
    throw std::runtime_error("a set-point is not confirmed");
  }
}

double p99(const std::function<void()>& call, std::chrono::milliseconds time) {
  std::vector<double> times;
  const auto begin = steady_clock::now();
  for (auto now = begin; now - begin < time;) {
    call();
    const auto after = steady_clock::now();
    times.push_back(std::chrono::duration<double, std::micro>(after - now).count());
    now = after;
  }
  const auto place = times.begin() + static_cast<std::ptrdiff_t>(times.size() * 99 / 100);
  std::nth_element(times.begin(), place, times.end());
  return *place;
}

double print(const RoundTrips& times) {
  std::vector<double> ratios;
  for (std::size_t i = 0; i < times.before.size(); ++i) {
    ratios.push_back(times.during[i] / times.before[i]);
  }
  const auto [least, most] = std::minmax_element(ratios.begin(), ratios.end());
  const double ratio = median(ratios);
  fmt::print("{:<44} p99 before  {:>10.0f} us, in it   {:>10.0f} us, ratio {:.2f} ({:.2f}..{:.2f})\n", times.what,
             median(times.before), median(times.during), ratio, *least, *most);
  std::fflush(stdout);
  return ratio;
}

}  // namespace bench
