#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <variant>

#include "canopen/bus/frame_tap.h"
#include "canopen/clock.h"
#include "canopen/frame.h"

// The format of `candump -L` and `-l`, which `canplayer` and Wireshark read: `(1767323045.678123) can0 185#01020304`.

namespace trace {

/// `185#0102`, `18FEF100#01` with 29 bits, `602#R` or `602#R8` for a remote request, `20000004#0004…` for an error
/// frame.
[[nodiscard]] std::string candump_frame(const canopen::Frame& frame);
/// A whole line, without its end.
[[nodiscard]] std::string candump_line(canopen::WallTime at, std::string_view interface, const canopen::Frame& frame);

/// A line of a log.
struct LoggedFrame {
  canopen::WallTime at{};
  std::string interface;
  canopen::Frame frame;
  canopen::FrameOrigin origin = canopen::FrameOrigin::others;  ///< Newer ones mark what was sent (` T`).
};

/// Why a line is none of a log, and what would be one.
struct NoFrame {
  std::string why;
};

/// Longer ones are none: those of candump have at most 60 bytes.
inline constexpr std::size_t kMaxLogLine = 200;

/// Reads one line, without its end. Of classic CAN only.
[[nodiscard]] std::variant<LoggedFrame, NoFrame> parse_candump_line(std::string_view line);

}  // namespace trace
