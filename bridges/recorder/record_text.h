#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "bridges/recorder/record.h"

namespace recorder {

/// What the log of a record holds.
struct LogFigures {
  struct Gap {
    canopen::WallTime wall;
    std::uint32_t frames = 0;
  };
  static constexpr std::size_t kMostGaps = 100;

  std::uint64_t frames = 0;  ///< Error frames included.
  std::uint64_t error_frames = 0;
  std::uint64_t lost = 0;   ///< Of all gaps.
  std::vector<Gap> gaps{};  ///< The first ones.
  bool shortened = false;   ///< The log ends early: it took all that records may take.
};

/// The JSON beside the log: docs/RECORDER.md.
[[nodiscard]] std::string record_json(const Record& record, const LogFigures& log);

/// What is listed of a record whose JSON is there.
struct RecordSummary {
  std::string bus;
  std::string drive;  ///< Empty: of the bus.
  bool first = false;
  std::uint64_t frames = 0;
  std::size_t commands = 0;
  friend bool operator==(const RecordSummary&, const RecordSummary&) = default;
};
/// Reads it out of such a JSON, which may be anything by now: nothing where it is none of ours.
[[nodiscard]] std::optional<RecordSummary> parse_summary(std::string_view text);

}  // namespace recorder
