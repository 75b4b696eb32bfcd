#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "canopen/clock.h"

namespace recorder {

/// What a record is called: `20260102T030405.678Z-pump1-emcy`. Names in their order are records in the order of time.
struct RecordName {
  canopen::WallTime wall{};  ///< Of its cause, in whole milliseconds.
  std::string subject;       ///< The drive, or the bus.
  std::string kind;          ///< Of the alarm: `emcy`, `heartbeat`, `boot`, `data`, `control`, `bus`; or `request`.
  friend bool operator==(const RecordName&, const RecordName&) = default;
};

inline constexpr std::string_view kLogSuffix = ".log";
inline constexpr std::string_view kJsonSuffix = ".json";
/// Behind either while it is being written.
inline constexpr std::string_view kNewSuffix = ".new";
inline constexpr std::string_view kRequest = "request";

/// Without a suffix.
[[nodiscard]] std::string to_text(const RecordName& name);
/// Reads exactly what to_text() makes; nothing on any other text.
[[nodiscard]] std::optional<RecordName> parse_record_name(std::string_view text);

}  // namespace recorder
