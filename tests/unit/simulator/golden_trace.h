#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "canopen/clock.h"
#include "canopen/frame.h"

namespace simulator {

struct TraceFrame {
  canopen::Duration at;  ///< since the first frame
  canopen::Frame frame;
};

/// The frames of tests/golden/NAME.log; throws std::runtime_error naming file and line when it cannot be read.
[[nodiscard]] std::vector<TraceFrame> golden_trace(std::string_view name);
/// The names of all traces, sorted.
[[nodiscard]] std::vector<std::string> golden_trace_names();

}  // namespace simulator
