#pragma once

#include <chrono>
#include <filesystem>
#include <optional>

#include "daemon/control/ask.h"

namespace gateway::control {

/// Where the daemon is found, and how long it may take to answer.
struct Daemon {
  /// Over the deadline of a drive, within which the gateway answers.
  static constexpr std::chrono::seconds kGrace{5};
  /// Of a drive whose deadline is not known here: as long as the configuration permits.
  static constexpr std::chrono::seconds kLongestDeadline{60};

  std::filesystem::path socket;  ///< Empty: the configuration has none.
  std::chrono::milliseconds patience = kLongestDeadline + kGrace;
};

/// Nothing where a configuration was named and is of no use; that is told.
[[nodiscard]] std::optional<Daemon> find_daemon(const Reach& reach);

}  // namespace gateway::control
