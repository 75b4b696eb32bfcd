#include <unistd.h>

#include <CLI/CLI.hpp>
#include <charconv>
#include <chrono>
#include <csignal>
#include <exception>
#include <filesystem>
#include <iostream>
#include <optional>
#include <sstream>

#include "canopen/clock.h"
#include "config/text.h"
#include "daemon/commands.h"
#include "daemon/control/ask.h"
#include "daemon/descriptors.h"
#include "daemon/output.h"

namespace {

std::optional<gateway::SimulatedDrive> parse_drive(const std::string& text) {
  const std::size_t colon = text.rfind(':');
  if (colon == std::string::npos || colon == 0) {
    return std::nullopt;
  }
  unsigned node = 0;
  const char* const end = text.data() + text.size();
  const auto [stopped, error] = std::from_chars(text.data() + colon + 1, end, node);
  if (error != std::errc{} || stopped != end || node < 1 || node > 127) {
    return std::nullopt;
  }
  return gateway::SimulatedDrive{text.substr(0, colon), static_cast<std::uint8_t>(node)};
}

std::string check_drive(const std::string& text) {
  return parse_drive(text) ? std::string{} : "\"" + text + "\" is not PROFILE:NODE with a node of 1..127";
}

// In milliseconds, as an event timer holds it (CiA 301, 0x1800:05).
std::optional<std::uint16_t> parse_event_timer(const std::string& text) {
  const std::optional<canopen::Duration> time = config::parse_duration(text);
  if (!time || !config::whole_milliseconds(*time) || *time < canopen::Duration::zero() ||
      *time > std::chrono::milliseconds(0xFFFF)) {
    return std::nullopt;
  }
  return static_cast<std::uint16_t>(*time / std::chrono::milliseconds(1));
}

std::string check_event_timer(const std::string& text) {
  return parse_event_timer(text) ? std::string{} : "\"" + text + "\" is no time of whole milliseconds, 0s..65535ms";
}

struct CommandLine {
  gateway::Options options;
  std::string map_format = "table";
  std::string interface;
  std::vector<std::string> drives;
  std::string tpdo;
  std::filesystem::path control;
  std::string drive;
  std::string bus;
  std::vector<std::string> assignments;
  std::string nmt_command;
  gateway::control::SdoOrder sdo;
  bool as_json = false;
};

// What goes through the running daemon.
CLI::App* add_asking(CLI::App& app, CommandLine& line, const std::string& name, const std::string& text) {
  CLI::App* const command = app.add_subcommand(name, text);
  command->add_option("--control", line.control, "The control socket of the daemon; else as the configuration says");
  return command;
}

void describe_sdo(CLI::App& sdo, CommandLine& line, const std::string& name, const std::string& text,
                  const std::string& words) {
  CLI::App* const way = sdo.add_subcommand(name, text);
  way->add_option("DRIVE", line.sdo.drive, "Its name")->required();
  way->add_option("OBJECT", line.sdo.object, "INDEX:SUB, as 0x2002:03")->required();
  way->add_option(words, line.sdo.words, "A type as u16 may be left out where a signal has the object");
}

void describe_asking(CLI::App& app, CommandLine& line) {
  CLI::App* const status = add_asking(app, line, "status", "How the running gateway and its drives are");
  status->add_flag("--json", line.as_json, "As JSON");
  CLI::App* const set = add_asking(app, line, "set", "Write signals of a drive");
  set->add_option("DRIVE", line.drive, "Its name")->required();
  set->add_option("SIGNAL=VALUE", line.assignments, "In engineering units; several are written together")->required();
  CLI::App* const record = add_asking(app, line, "record", "Record the frames before and after now");
  record->add_option("DRIVE", line.drive, "Its name");
  record->add_option("--bus", line.bus, "A whole bus in place of a drive");
  add_asking(app, line, "stop", "Stop every drive that takes commands of the command line");
  CLI::App* const nmt = add_asking(app, line, "nmt", "Command the state of a drive's node");
  nmt->add_option("DRIVE", line.drive, "Its name")->required();
  nmt->add_option("COMMAND", line.nmt_command, "start, stop, pre-operational, reset-node or reset-communication")
      ->required();
  CLI::App* const sdo = add_asking(app, line, "sdo", "Read or write an object of a drive");
  sdo->require_subcommand(1);
  sdo->fallthrough();
  describe_sdo(*sdo, line, "read", "Read an object, raw as the drive holds it", "TYPE");
  describe_sdo(*sdo, line, "write", "Write an object, raw as the drive holds it", "TYPE VALUE");
}

int carry_out_asking(const CLI::App& app, CommandLine line) {
  const gateway::control::Reach reach{line.options, line.control};
  if (app.got_subcommand("set")) {
    return gateway::control::set(reach, line.drive, line.assignments);
  }
  if (app.got_subcommand("nmt")) {
    return gateway::control::nmt(reach, line.drive, line.nmt_command);
  }
  if (app.got_subcommand("status")) {
    return gateway::control::status(reach, line.as_json);
  }
  if (app.got_subcommand("record")) {
    return gateway::control::record(reach, line.drive, line.bus);
  }
  if (app.got_subcommand("stop")) {
    return gateway::control::stop(reach);
  }
  if (app.get_subcommand("sdo")->got_subcommand("write")) {
    line.sdo.way = gateway::control::SdoOrder::Way::write;
  }
  return gateway::control::sdo(reach, line.sdo);
}

// Exits as the commands do; the value of the option tells whether --config was given.
void describe(CLI::App& app, CommandLine& line) {
  app.require_subcommand(1);
  app.set_version_flag("--version", GATEWAY_VERSION);
  app.fallthrough();
  app.add_option("--config", line.options.config, "The configuration file")->capture_default_str();
  app.add_option("--profile-dir", line.options.profile_dirs, "A directory of profiles to look in first; repeatable")
      ->allow_extra_args(false)
      ->check(CLI::ExistingDirectory);
  app.add_flag("--verbose", line.options.verbose, "Log debug messages too");

  app.add_subcommand("run", "The daemon, in the foreground");
  app.add_subcommand("check", "Validate the configuration and every profile it names");
  CLI::App* const map = app.add_subcommand("map", "Every signal with its object, Modbus address and MQTT topics");
  map->add_option("--format", line.map_format, "table, json, csv or markdown")
      ->check(CLI::IsMember({"table", "json", "csv", "markdown"}))
      ->capture_default_str();
  CLI::App* const simulate = app.add_subcommand("simulate", "Simulated drives on a SocketCAN interface");
  CLI::Option* const interface = simulate->add_option("--interface", line.interface, "The SocketCAN interface");
  CLI::Option* const drives =
      simulate->add_option("--drive", line.drives, "PROFILE:NODE; repeatable")->allow_extra_args(false);
  drives->check(CLI::Validator(check_drive, "PROFILE:NODE"));
  drives->needs(interface);
  interface->needs(drives);
  simulate->add_option("--tpdo", line.tpdo, "Event timer of the drives' TPDOs at power-up")
      ->check(CLI::Validator(check_event_timer, "DURATION"));
  app.add_subcommand("demo", "Simulated drives of the four systems and the gateway, without CAN hardware");
  describe_asking(app, line);
  CLI::App* const journal = app.add_subcommand("journal", "The journal of commands");
  journal->require_subcommand(1);
  journal->add_subcommand("verify", "Whether it is whole and unchanged");
}

int carry_out(const CLI::App& app, const CommandLine& line) {
  if (app.got_subcommand("run")) {
    return gateway::run(line.options);
  }
  if (app.got_subcommand("check")) {
    return gateway::check(line.options);
  }
  if (app.got_subcommand("map")) {
    return gateway::show_map(line.options, line.map_format);
  }
  if (app.got_subcommand("journal")) {
    return gateway::verify_journal(line.options);
  }
  if (app.got_subcommand("demo")) {
    return gateway::demo(line.options);
  }
  if (!app.got_subcommand("simulate")) {
    return carry_out_asking(app, line);
  }
  gateway::Simulation simulation{line.interface, {}, parse_event_timer(line.tpdo)};
  for (const std::string& text : line.drives) {
    simulation.drives.push_back(parse_drive(text).value());
  }
  return gateway::simulate(line.options, simulation);
}

// Of --help and --version, and of what was wrong with the command line.
int answer(const CLI::App& app, const CLI::ParseError& error) {
  std::ostringstream out;
  std::ostringstream wrong;
  const int code = app.exit(error, out, wrong);
  std::cerr << gateway::with_priority(STDERR_FILENO, config::Finding::Level::error, wrong.str());
  gateway::print(out.str());
  return code == 0 ? gateway::kDone : gateway::kUsage;
}

int obey(int argc, char** argv) {
  CLI::App app("CANopen master with Modbus TCP and MQTT", "canopen-gateway");
  CommandLine line;
  describe(app, line);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return answer(app, error);
  }
  line.options.config_given = app.count("--config") > 0;
  return carry_out(app, line);
}

}  // namespace

int main(int argc, char** argv) {
  try {
    gateway::open_missing_descriptors();
    // Whoever reads our output may go. Writing then fails, which commands tell, and `run` outlives.
    std::signal(SIGPIPE, SIG_IGN);
    return obey(argc, argv);
  } catch (const std::exception& error) {
    gateway::complain(error.what());
    return gateway::kFailed;
  }
}
