#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace bench {

struct ModbusLoad {
  std::uint16_t port = 0;  ///< On 127.0.0.1.
  std::uint8_t unit = 0;
  int clients = 1;
  std::chrono::milliseconds time{1000};
};

struct ModbusTimes {
  double per_second = 0;
  std::vector<float> took;  ///< Each request, in µs; sorted.

  /// In µs: what this part of all requests took at most.
  [[nodiscard]] float within(double part) const {
    return took.at(static_cast<std::size_t>(part * static_cast<double>(took.size() - 1)));
  }
};

/// Function 3, ten registers from 0, asked by `clients` connections, each with one request under way. Throws
/// std::runtime_error for anything but a normal answer: a rate of errors is no rate.
[[nodiscard]] ModbusTimes ask(const ModbusLoad& load);

}  // namespace bench
