#pragma once

#include <sys/types.h>

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <string>
#include <system_error>

#include "daemon/doctor/line.h"

namespace gateway::doctor {

/// Whether the gateway of this configuration runs. What is unknown accuses nobody: it may be a plant that works.
enum class Presence : std::uint8_t { runs, absent, unknown };

/// What came of asking it on its control socket.
struct GatewayFacts {
  std::error_code error{};  ///< Of the way to it.
  std::string silence{};    ///< Somebody listens there, but did not answer: why.
  pid_t process = 0;        ///< Who listens there; 0: not known.
};

/// Blocks for `patience` at most. `socket`: empty where the configuration has none.
[[nodiscard]] GatewayFacts ask_gateway(const std::filesystem::path& socket, std::chrono::milliseconds patience);
[[nodiscard]] Presence presence_of(const std::filesystem::path& socket, const GatewayFacts& facts) noexcept;
[[nodiscard]] Line judge(const std::filesystem::path& socket, const GatewayFacts& facts);

}  // namespace gateway::doctor
