#include "daemon/command_line.h"

#include <CLI/CLI.hpp>
#include <charconv>
#include <system_error>

#include "canopen/clock.h"
#include "config/text.h"

namespace gateway {
namespace {

std::string check_drive(const std::string& text) {
  return parse_drive(text) ? std::string{} : "\"" + text + "\" is not PROFILE:NODE with a node of 1..127";
}

std::string check_event_timer(const std::string& text) {
  return parse_event_timer(text) ? std::string{} : "\"" + text + "\" is no time of whole milliseconds, 0s..65535ms";
}

std::string check_listening(const std::string& text) {
  return parse_listening(text) ? std::string{} : "\"" + text + "\" is no time of up to 60s";
}

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

}  // namespace

std::optional<SimulatedDrive> parse_drive(const std::string& text) {
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
  return SimulatedDrive{text.substr(0, colon), static_cast<std::uint8_t>(node)};
}

std::optional<std::uint16_t> parse_event_timer(const std::string& text) {
  const std::optional<canopen::Duration> time = config::parse_duration(text);
  if (!time || !config::whole_milliseconds(*time) || *time < canopen::Duration::zero() ||
      *time > std::chrono::milliseconds(0xFFFF)) {
    return std::nullopt;
  }
  return static_cast<std::uint16_t>(*time / std::chrono::milliseconds(1));
}

std::optional<std::chrono::milliseconds> parse_listening(const std::string& text) {
  const std::optional<canopen::Duration> time = config::parse_duration(text);
  if (!time || *time <= canopen::Duration::zero() || *time > std::chrono::minutes(1)) {
    return std::nullopt;
  }
  return std::chrono::ceil<std::chrono::milliseconds>(*time);
}

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

}  // namespace gateway
