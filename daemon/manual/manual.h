#pragma once

#include <string>
#include <vector>

namespace CLI {  // NOLINT(readability-identifier-naming): theirs
class App;
}

// What is installed beside the program and made by it, of the tables that it works with itself: the manual pages and
// the completion of bash. Asked for when the program is built; nothing else reads it.

namespace gateway::manual {

/// An option or an argument of a command.
struct Option {
  std::string name;  ///< `--format TEXT`, `DRIVE`
  std::string flag;  ///< `--format`; empty: an argument.
  std::string meaning;
  bool takes_value = false;
};

/// A command, and those below it.
struct Command {
  std::string name;
  std::string meaning;
  std::vector<Option> options;
  std::vector<Command> below;
};

/// What the command line knows, without what is hidden there.
[[nodiscard]] Command describe(const CLI::App& app);

/// canopen-gateway(1)
[[nodiscard]] std::string command_page(const Command& program);
/// gateway.toml(5)
[[nodiscard]] std::string configuration_page();
/// Commands and options for bash; names of drives are asked from `map`.
[[nodiscard]] std::string bash_completion(const Command& program);

}  // namespace gateway::manual
