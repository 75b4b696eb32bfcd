#pragma once

#include <chrono>
#include <cstdint>

namespace bench {

struct ModbusLoad {
  std::uint16_t port = 0;  ///< On 127.0.0.1.
  std::uint8_t unit = 0;
  int clients = 1;
  std::chrono::milliseconds time{1000};
};

/// Function 3, ten registers from 0, asked by `clients` connections, each with one request under way. Requests per
/// second. Throws std::runtime_error for anything but a normal answer: a rate of errors is no rate.
[[nodiscard]] double requests_per_second(const ModbusLoad& load);

}  // namespace bench
