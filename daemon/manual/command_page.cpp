#include "daemon/manual/manual.h"
#include "daemon/manual/roff.h"

namespace gateway::manual {
namespace {

// "Names the reader may see" become sentences: the help has them without a full stop.
std::string sentence(const std::string& text) {
  return text.empty() || text.ends_with('.') ? text : text + ".";
}

std::string synopsis_of(const Command& command, const std::string& path) {
  std::string line = path;
  for (const Option& option : command.options) {
    line += option.flag.empty() ? " " + option.name : " [" + option.name + "]";
  }
  return line;
}

void add_command(const Command& command, const std::string& path, std::string& out) {
  if (command.below.empty()) {
    out += subheading(synopsis_of(command, path)) + roff(sentence(command.meaning)) + "\n";
    for (const Option& option : command.options) {
      out += tagged(option.name, sentence(option.meaning));
    }
  }
  for (const Command& below : command.below) {
    add_command(below, path + " " + below.name, out);
  }
}

}  // namespace

std::string command_page(const Command& program) {
  std::string out = ".TH CANOPEN\\-GATEWAY 1 \"\" \"canopen\\-gateway " + roff(GATEWAY_VERSION) + "\"\n";
  out += heading("NAME") + "canopen\\-gateway \\- " + roff(program.meaning) + "\n";
  out += heading("SYNOPSIS") + roff("`canopen-gateway` [OPTION]... COMMAND [ARGUMENT]...") + "\n";
  out += heading("DESCRIPTION") +
         roff(
             "A CANopen master of drives. It shows their values to Modbus TCP and MQTT, and carries commands to them, "
             "where the configuration lets somebody command. It is not a safety function: emergency stop and STO are "
             "wired to the drive.") +
         "\n";
  out += heading("OPTIONS");
  for (const Option& option : program.options) {
    out += tagged(option.name, sentence(option.meaning));
  }
  out += heading("COMMANDS");
  for (const Command& command : program.below) {
    add_command(command, command.name, out);
  }
  out += heading("EXIT STATUS") + tagged("0", "Done; warnings do not change it.") +
         tagged("1", "Failed, for example a full disk under the output, or a command that the gateway refused.") +
         tagged("2", "Wrong usage.") +
         tagged("78", "The configuration is wrong; systemd does not start the gateway again.");
  out += heading("SIGNALS") + tagged("SIGTERM, SIGINT", "Ends `run` in order; nothing is sent to drives.");
  out +=
      heading("FILES") + tagged("/etc/canopen-gateway/gateway.toml", "The configuration, see gateway.toml(5).") +
      tagged("/etc/canopen-gateway/profiles", "The site's own profiles of drives; they come before those installed.") +
      tagged("/usr/share/canopen-gateway/profiles", "The profiles that are installed.") +
      tagged("/usr/share/canopen-gateway/gateway.toml.example", "A configuration to start from: one drive, watched.") +
      tagged("/usr/share/canopen-gateway/gateway.toml.four-drives",
             "All four kinds, with commands, to take parts from.") +
      tagged("/var/lib/canopen-gateway", "Alarms, records, and the journal of commands.") +
      tagged("/run/canopen-gateway/control", "The control socket of the running gateway.");
  out += heading("SEE ALSO") + "gateway.toml(5), systemctl(1), ip\\-link(8)\n.PP\n" +
         roff("The manual is in /usr/share/doc/canopen-gateway.") + "\n";
  return out;
}

}  // namespace gateway::manual
