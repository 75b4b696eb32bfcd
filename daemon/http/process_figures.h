#pragma once

#include <cstdint>

namespace gateway::http {

/// What the system tells of this process (proc(5)); 0 where it does not.
struct ProcessFigures {
  double cpu_seconds = 0;  ///< User and system.
  double start_time = 0;   ///< Seconds since 1970, by the time of day that the system has now.
  std::uint64_t virtual_bytes = 0;
  std::uint64_t resident_bytes = 0;
  std::uint64_t open_descriptors = 0;
  std::uint64_t max_descriptors = 0;
};

[[nodiscard]] ProcessFigures process_figures();

}  // namespace gateway::http
