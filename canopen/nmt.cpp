#include "canopen/nmt.h"

#include <array>

namespace canopen {
namespace {

struct CommandName {
  NmtCommand command;
  std::string_view name;
};

constexpr std::array kCommands{CommandName{NmtCommand::start, "start"}, CommandName{NmtCommand::stop, "stop"},
                               CommandName{NmtCommand::pre_operational, "pre-operational"},
                               CommandName{NmtCommand::reset_node, "reset-node"},
                               CommandName{NmtCommand::reset_communication, "reset-communication"}};

}  // namespace

std::string_view name_of(NmtState state) noexcept {
  switch (state) {
    case NmtState::initialising:
      return "initialising";
    case NmtState::stopped:
      return "stopped";
    case NmtState::operational:
      return "operational";
    case NmtState::pre_operational:
      return "pre-operational";
    case NmtState::unknown:
      return "unknown";
  }
  return "unknown";
}

std::string_view name_of(NmtCommand command) noexcept {
  for (const CommandName& known : kCommands) {
    if (known.command == command) {
      return known.name;
    }
  }
  return "unknown";
}

std::optional<NmtCommand> parse_nmt_command(std::string_view name) noexcept {
  for (const CommandName& known : kCommands) {
    if (known.name == name) {
      return known.command;
    }
  }
  return std::nullopt;
}

std::optional<NmtCommand> nmt_command_of(std::uint64_t number) noexcept {
  for (const CommandName& known : kCommands) {
    if (static_cast<std::uint64_t>(known.command) == number) {
      return known.command;
    }
  }
  return std::nullopt;
}

}  // namespace canopen
