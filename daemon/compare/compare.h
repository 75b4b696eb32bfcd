#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "config/drive_notes.h"
#include "config/model.h"
#include "config/toml/report.h"
#include "daemon/compare/drive_view.h"
#include "daemon/compare/reading.h"

// `check --live`: what the configuration says of the drives, and what the running gateway and its drives show.

namespace gateway::compare {

/// A drive as the running gateway has it.
struct RunningDrive {
  std::string name;
  std::string bus;
  std::int64_t node = 0;
  std::string profile;
  bool enabled = true;
  bool online = false;
  std::string nmt;
  std::string boot;  ///< `ok`, `not-booted`, or the letter.
  std::string boot_text;
};

/// The running gateway, of what its `status` tells.
struct Running {
  std::string gateway;
  double uptime = 0.0;  ///< Seconds.
  std::vector<RunningDrive> drives;
};

/// Of the line that answered `status`; nothing where it is no such answer.
[[nodiscard]] std::optional<Running> read_running(std::string_view answer);

/// What was found.
struct Comparison {
  config::Findings findings;
  std::size_t drives = 0;  ///< Compared to the end.
  Counts objects;
};

/// Compares all drives that are in service, one after the other and one object at a time, by reading alone. `notes` are
/// those of the model's drives. A drive that is offline, or falls silent, is a warning; one whose boot ended with a
/// letter is an error, and compared as far as it answers.
[[nodiscard]] Comparison compare(const config::Model& model, std::span<const config::DriveNotes> notes,
                                 const Running& running, const Ask& ask);

/// `live: 4 drives compared, 62 objects as configured, 17 that a drive does not have`
[[nodiscard]] std::string summary(const Comparison& comparison);

}  // namespace gateway::compare
