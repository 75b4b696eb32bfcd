#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "config/load.h"

namespace gateway {

/// Exit codes; scripts and the service manager rely on them.
inline constexpr int kDone = 0;
inline constexpr int kFailed = 1;
inline constexpr int kUsage = 2;
inline constexpr int kConfigurationError = 78;  ///< EX_CONFIG of sysexits.h: systemd does not restart on it.

/// What the command line said, common to all commands.
struct Options {
  std::filesystem::path config = "/etc/canopen-gateway/gateway.toml";
  bool config_given = false;
  std::vector<std::filesystem::path> profile_dirs;  ///< Looked in before the site's and the installed profiles.
  bool verbose = false;                             ///< Log debug messages too.
};

/// What the loader needs: the file, and every profile directory in the order in which it is searched.
[[nodiscard]] config::LoadOptions load_options(const Options& options);

/// Prints findings to standard error, each a line.
void show_findings(const config::Findings& findings);

/// Whether the file of the password is read, which only those who connect to a broker need.
enum class Secrets : std::uint8_t { leave, read };

/// Loads the configuration and prints its findings to standard error; nothing where there is an error.
[[nodiscard]] std::optional<config::Model> load_or_complain(const Options& options, Secrets secrets);

}  // namespace gateway
