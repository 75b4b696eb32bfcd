#include <CLI/CLI.hpp>

#include "daemon/manual/manual.h"

namespace gateway::manual {
namespace {

Option describe_option(const CLI::Option& option) {
  const bool argument = option.get_positional();
  Option described{option.get_name(argument), {}, option.get_description(), option.get_items_expected_max() > 0};
  if (!argument) {
    described.flag = option.get_lnames().empty() ? described.name : "--" + option.get_lnames().front();
  }
  if (!argument && described.takes_value) {
    described.name += " " + (option.get_type_name().empty() ? "VALUE" : option.get_type_name());
  }
  if (!option.get_default_str().empty()) {
    described.meaning += " (default " + option.get_default_str() + ")";
  }
  return described;
}

}  // namespace

Command describe(const CLI::App& app) {
  Command command{app.get_name(), app.get_description(), {}, {}};
  for (const CLI::Option* const option : app.get_options()) {
    // Each command has --help; it is said once.
    const bool again = app.get_parent() != nullptr && option == app.get_help_ptr();
    if (!option->get_group().empty() && !again) {
      command.options.push_back(describe_option(*option));
    }
  }
  for (const CLI::App* const below :
       app.get_subcommands([](const CLI::App* each) { return !each->get_group().empty(); })) {
    command.below.push_back(describe(*below));
  }
  return command;
}

}  // namespace gateway::manual
