#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "daemon/options.h"

// The commands of the program. Each returns its exit code and lets nothing but a start-up failure throw.

namespace gateway {

/// `run`: the daemon, in the foreground, until SIGINT or SIGTERM.
[[nodiscard]] int run(const Options& options);

/// `check`: findings, then `ok: …` on standard output.
[[nodiscard]] int check(const Options& options);

/// `map`: every signal with its object, Modbus address and topics, in one of the formats of map.h.
[[nodiscard]] int show_map(const Options& options, const std::string& format);

/// One simulated drive on the command line: `PROFILE:NODE`.
struct SimulatedDrive {
  std::string kind;
  std::uint8_t node = 0;
};

/// `simulate`: drives on `interface`, or all drives of the configuration where `interface` is empty. Takes orders to
/// misbehave from standard input.
[[nodiscard]] int simulate(const Options& options, const std::string& interface,
                           const std::vector<SimulatedDrive>& drives);

/// `demo`: simulated drives and the gateway on one in-process bus.
[[nodiscard]] int demo(const Options& options);

}  // namespace gateway
