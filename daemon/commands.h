#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "daemon/options.h"

// The commands of the program. Each returns its exit code and lets nothing but a start-up failure throw.

namespace gateway {

/// `run`: the daemon, in the foreground, until SIGINT or SIGTERM.
[[nodiscard]] int run(const Options& options);

/// `check`: findings, then `ok: …` on standard output.
[[nodiscard]] int check(const Options& options);

/// `check --live`: the same, and how the drives of the running gateway differ from the configuration. `control`: its
/// socket; empty: as the configuration says.
[[nodiscard]] int check_live(const Options& options, const std::filesystem::path& control);

/// Findings as `check` prints them, each a line.
[[nodiscard]] std::string text_of(const config::Findings& findings);

/// `doctor`: what on this machine would keep the gateway from working; looks only, and sends nothing on a bus. Listens
/// on each for `listening`; nothing: as long as its drives may be silent, at least 3 s.
[[nodiscard]] int examine(const Options& options, std::optional<std::chrono::milliseconds> listening);

/// `map`: every signal with its object, Modbus address and topics, in one of the formats of map.h.
[[nodiscard]] int show_map(const Options& options, const std::string& format);

/// `journal verify`: whether the journal of commands is whole and unchanged.
[[nodiscard]] int verify_journal(const Options& options);

/// One simulated drive on the command line: `PROFILE:NODE`.
struct SimulatedDrive {
  std::string kind;
  std::uint8_t node = 0;
};

/// What `simulate` was asked for.
struct Simulation {
  std::string interface;               ///< Empty: all drives of the configuration, on the interfaces of their buses.
  std::vector<SimulatedDrive> drives;  ///< On `interface`.
  std::optional<std::uint16_t> tpdo_event_ms;  ///< Event timer of all TPDOs at power-on; nothing: as each kind has it.
};

/// `simulate`: takes orders to misbehave from standard input.
[[nodiscard]] int simulate(const Options& options, const Simulation& simulation);

/// `demo`: simulated drives and the gateway on one in-process bus.
[[nodiscard]] int demo(const Options& options);

}  // namespace gateway
