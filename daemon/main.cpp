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
#include "daemon/manual/manual.h"
#include "daemon/output.h"
#include "daemon/trace_log.h"

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

std::optional<std::chrono::milliseconds> parse_listening(const std::string& text) {
  const std::optional<canopen::Duration> time = config::parse_duration(text);
  if (!time || *time <= canopen::Duration::zero() || *time > std::chrono::minutes(1)) {
    return std::nullopt;
  }
  return std::chrono::ceil<std::chrono::milliseconds>(*time);
}

std::string check_listening(const std::string& text) {
  return parse_listening(text) ? std::string{} : "\"" + text + "\" is no time of up to 60s";
}

struct CommandLine {
  gateway::Options options;
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
  gateway::control::SdoOrder sdo;
  bool as_json = false;
  bool watch = false;
  std::vector<std::string> traced;
  std::vector<std::string> kinds;
  std::vector<std::string> cob_ids;
  bool raw = false;
  bool of_buses = false;
  bool live = false;
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

void describe_trace(CLI::App& app, CommandLine& line) {
  CLI::App* const trace = add_asking(app, line, "trace", "The frames of the buses in words");
  trace->add_option("NAME", line.traced,
                    "A drive or bus of the running gateway; or a candump log, as ./FILE or FILE.log");
  trace->add_option("--kind", line.kinds, "nmt, heartbeat, sdo, pdo, emcy, sync, error, other; repeatable")
      ->allow_extra_args(false);
  trace->add_option("--id", line.cob_ids, "A COB-ID, hexadecimal; repeatable")->allow_extra_args(false);
  trace->add_flag("--raw", line.raw, "As candump -L writes them");
}

void describe_asking(CLI::App& app, CommandLine& line) {
  CLI::App* const status = add_asking(app, line, "status", "How the running gateway and its drives are");
  status->add_flag("--json", line.as_json, "As JSON");
  status->add_flag("--buses", line.of_buses, "How sound the buses are, in figures");
  status->add_flag("--watch", line.watch, "Again at each change, until Ctrl-C");
  describe_trace(app, line);
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

std::string with_commas(const std::vector<std::string>& words) {
  std::string list;
  for (const std::string& word : words) {
    list.append(list.empty() ? "" : ",").append(word);
  }
  return list;
}

// No drive and no bus has a dot or a slash in its name.
bool is_log(const std::string& word) {
  return word == "-" || word.find_first_of("./") != std::string::npos;
}

int carry_out_trace(const gateway::control::Reach& reach, const CommandLine& line) {
  std::vector<std::string> logs;
  std::vector<std::string> names;
  for (const std::string& word : line.traced) {
    (is_log(word) ? logs : names).push_back(word);
  }
  const trace::FilterWords filter{with_commas(names), with_commas(line.kinds), with_commas(line.cob_ids)};
  if (logs.empty()) {
    return gateway::control::trace(reach, filter, line.raw);
  }
  if (logs.size() > 1) {
    gateway::complain("trace takes one log");
    return gateway::kUsage;
  }
  return gateway::trace_log(line.options, logs.front(), filter, line.raw);
}

int carry_out_asking(const CLI::App& app, CommandLine line) {
  const gateway::control::Reach reach{line.options, line.control};
  if (app.got_subcommand("set")) {
    return gateway::control::set(reach, line.drive, line.assignments);
  }
  if (app.got_subcommand("nmt")) {
    return gateway::control::nmt(reach, line.drive, line.nmt_command);
  }
  if (app.got_subcommand("trace")) {
    return carry_out_trace(reach, line);
  }
  if (app.got_subcommand("status")) {
    if (line.of_buses) {
      return gateway::control::buses(reach, line.as_json);
    }
    return line.watch ? gateway::control::watch_status(reach, line.as_json)
                      : gateway::control::status(reach, line.as_json);
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
  CLI::App* const check = add_asking(
      app, line, "check", "Validate the configuration and every profile it names, and say how long a restart may take");
  CLI::Option* const live = check->add_flag("--live", line.live, "Compare with the drives of the running daemon too");
  check->get_option("--control")->needs(live);
  CLI::App* const doctor = app.add_subcommand("doctor", "What on this machine would keep the gateway from working");
  doctor
      ->add_option("--listen", line.listening,
                   "How long to listen on each bus, up to 60s (default: as a drive may be silent, at least 3s)")
      ->check(CLI::Validator(check_listening, "DURATION"));
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
  CLI::App* const manual = app.add_subcommand("manual", "What is installed beside the program")->group("");
  manual->require_subcommand(1);
  for (const char* const page : {"commands", "configuration", "completion"}) {
    manual->add_subcommand(page);
  }
}

// Asked for when the program is built, so that manual pages and completion never lag behind it.
int write_manual(const CLI::App& app) {
  namespace manual = gateway::manual;
  const CLI::App& which = *app.get_subcommand("manual");
  if (which.got_subcommand("configuration")) {
    gateway::print(manual::configuration_page());
  } else if (which.got_subcommand("completion")) {
    gateway::print(manual::bash_completion(manual::describe(app)));
  } else {
    gateway::print(manual::command_page(manual::describe(app)));
  }
  return gateway::kDone;
}

int carry_out(const CLI::App& app, const CommandLine& line) {
  if (app.got_subcommand("run")) {
    return gateway::run(line.options);
  }
  if (app.got_subcommand("check")) {
    return line.live ? gateway::check_live(line.options, line.control) : gateway::check(line.options);
  }
  if (app.got_subcommand("doctor")) {
    return gateway::examine(line.options, parse_listening(line.listening));
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
  if (app.got_subcommand("manual")) {
    return write_manual(app);
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
