#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "bridges/trace/filter.h"
#include "daemon/options.h"

// The commands of the program that go through the running daemon. Each returns its exit code: kDone, kFailed where the
// gateway refused or cannot be reached, kUsage for arguments that make no request.

namespace gateway::control {

/// What all of them need to find the daemon.
struct Reach {
  Options options;
  std::filesystem::path socket;  ///< Empty: the one of the configuration, else the usual one.
};

/// `set DRIVE SIGNAL=VALUE…`
[[nodiscard]] int set(const Reach& reach, const std::string& drive, const std::vector<std::string>& assignments);

/// `nmt DRIVE COMMAND`
[[nodiscard]] int nmt(const Reach& reach, const std::string& drive, const std::string& command);

/// `sdo read|write DRIVE INDEX:SUB [TYPE] [VALUE]`
struct SdoOrder {
  enum class Way : std::uint8_t { read, write };
  Way way = Way::read;
  std::string drive;
  std::string object;
  std::vector<std::string> words;  ///< What stands behind: type, value; of a write the last one is the value.
};
[[nodiscard]] int sdo(const Reach& reach, const SdoOrder& order);

/// `status`: a table for people, or the JSON of the gateway.
[[nodiscard]] int status(const Reach& reach, bool as_json);

/// `status --watch`: the table redrawn in a terminal, printed anew into a pipe where it tells something else; or each
/// status as JSON. Until SIGINT or SIGTERM (kDone), or the gateway's end (kFailed).
[[nodiscard]] int watch_status(const Reach& reach, bool as_json);

/// `trace`: the frames of the running gateway's buses in words, or as candump writes them. It ends likewise.
[[nodiscard]] int trace(const Reach& reach, const trace::FilterWords& filter, bool raw);

/// `status --buses`: how sound the buses are, likewise.
[[nodiscard]] int buses(const Reach& reach, bool as_json);

/// `record DRIVE` or `record --bus BUS`: one of the two is empty.
[[nodiscard]] int record(const Reach& reach, const std::string& drive, const std::string& bus);

/// `stop`: every drive that takes commands of the command line gets its stop value.
[[nodiscard]] int stop(const Reach& reach);

}  // namespace gateway::control
