#pragma once

#include <CLI/App.hpp>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "daemon/commands.h"
#include "daemon/control/ask.h"

namespace gateway {

/// What was given on the command line, as words that describe() has checked.
struct CommandLine {
  Options options;
  std::string map_format = "table";
  std::string interface;
  std::vector<std::string> drives;
  std::string tpdo;
  std::string listening;
  std::filesystem::path control;
  std::string drive;
  std::string bus;
  std::vector<std::string> assignments;
  std::string nmt_command;
  control::SdoOrder sdo;
  bool as_json = false;
  bool watch = false;
  std::vector<std::string> traced;
  std::vector<std::string> kinds;
  std::vector<std::string> cob_ids;
  bool raw = false;
  bool of_buses = false;
  bool live = false;
};

/// Every command with its options, which a parse puts into `line`. Both outlive it.
void describe(CLI::App& app, CommandLine& line);

/// `PROFILE:NODE`
[[nodiscard]] std::optional<SimulatedDrive> parse_drive(const std::string& text);
/// In milliseconds, as an event timer holds it (CiA 301, 0x1800:05).
[[nodiscard]] std::optional<std::uint16_t> parse_event_timer(const std::string& text);
/// A time of up to a minute.
[[nodiscard]] std::optional<std::chrono::milliseconds> parse_listening(const std::string& text);

}  // namespace gateway
