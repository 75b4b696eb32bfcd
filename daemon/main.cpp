#include <unistd.h>

#include <CLI/CLI.hpp>
#include <csignal>
#include <exception>
#include <iostream>
#include <sstream>

#include "bridges/mqtt/tls_handshake.h"
#include "daemon/command_line.h"
#include "daemon/commands.h"
#include "daemon/control/ask.h"
#include "daemon/descriptors.h"
#include "daemon/manual/manual.h"
#include "daemon/output.h"
#include "daemon/trace_log.h"

namespace {

using gateway::CommandLine;

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
    return gateway::examine(line.options, gateway::parse_listening(line.listening));
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
  gateway::Simulation simulation{line.interface, {}, gateway::parse_event_timer(line.tpdo)};
  for (const std::string& text : line.drives) {
    simulation.drives.push_back(gateway::parse_drive(text).value());
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
  gateway::describe(app, line);
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
    mqtt::keep_tls_until_the_end();
    return obey(argc, argv);
  } catch (const std::exception& error) {
    gateway::complain(error.what());
    return gateway::kFailed;
  }
}
