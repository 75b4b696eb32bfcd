#pragma once

#include <filesystem>

#include "bridges/trace/filter.h"
#include "daemon/options.h"

namespace gateway {

/// `trace FILE`: a log in the format of `candump -L`, `-` for standard input, in words by the configuration, or as it
/// is
/// (`raw`). What is no line of a log is named and passed over; then the exit code is kFailed.
[[nodiscard]] int trace_log(const Options& options, const std::filesystem::path& log, const trace::FilterWords& filter,
                            bool raw);

}  // namespace gateway
