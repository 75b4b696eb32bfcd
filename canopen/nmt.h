#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

namespace canopen {

/// State of a node as its heartbeat tells it (CiA 301 §7.3.2.2). The numbers are those of Modbus register 1001.
enum class NmtState : std::uint8_t {
  initialising = 0,  ///< Boot-up message seen, nothing since.
  stopped = 4,
  operational = 5,
  pre_operational = 127,
  unknown = 255
};

/// NMT commands (CiA 301 §7.2.8.3.1).
enum class NmtCommand : std::uint8_t {
  start = 1,
  stop = 2,
  pre_operational = 128,
  reset_node = 129,
  reset_communication = 130
};

/// `initialising`, `stopped`, `operational`, `pre-operational`, `unknown`.
[[nodiscard]] std::string_view name_of(NmtState state) noexcept;
/// `start`, `stop`, `pre-operational`, `reset-node`, `reset-communication`.
[[nodiscard]] std::string_view name_of(NmtCommand command) noexcept;
[[nodiscard]] std::optional<NmtCommand> parse_nmt_command(std::string_view name) noexcept;
/// Of a command specifier 1, 2, 128, 129, 130.
[[nodiscard]] std::optional<NmtCommand> nmt_command_of(std::uint64_t number) noexcept;

}  // namespace canopen
