#pragma once

#include <string>

namespace gateway {

/// Logging while one lives: asynchronous, never waited for. When the disk or the journal stalls, the oldest messages
/// are dropped and counted. On the journal each line carries its priority,
/// elsewhere the time.
class Log {
 public:
  explicit Log(bool verbose);
  ~Log();
  Log(const Log&) = delete;
  Log& operator=(const Log&) = delete;

  /// Messages dropped since the start.
  [[nodiscard]] static std::size_t dropped();
};

}  // namespace gateway
