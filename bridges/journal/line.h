#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "canopen/clock.h"

namespace journal {

/// What the first line of all has as `prev`.
inline constexpr std::string_view kNoHash = "0000000000000000000000000000000000000000000000000000000000000000";

/// Longer ones are no lines of ours.
inline constexpr std::size_t kMaxLine = 1024UL * 1024;

/// What the chain needs to know of a line.
struct Line {
  std::uint64_t n = 0;
  std::string ts;
  std::string phase;
  std::string prev;
  std::uint64_t bytes = 0;  ///< Of phase `torn`: what stands before it and is no line.
  std::string sha256;       ///< Likewise.
  std::uint64_t count = 0;  ///< Of phase `lost`.
};

/// Nothing where it is no line of a journal. `text` is without its line break, any bytes.
[[nodiscard]] std::optional<Line> parse_line(std::string_view text);

/// A line that is to be written: all but its place in the chain.
struct Entry {
  canopen::WallTime wall;
  canopen::TimePoint at;
  std::string members;  ///< JSON members without braces: `"phase":"done",…`
};

/// The line without its line break.
[[nodiscard]] std::string make_line(const Entry& entry, std::uint64_t n, std::string_view prev);

}  // namespace journal
