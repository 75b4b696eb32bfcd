#pragma once

#include <cstddef>
#include <string>

#include "canopen/node/setup_session.h"
#include "config/model.h"
#include "config/toml/report.h"
#include "daemon/compare/reading.h"

namespace gateway::compare {

/// How many objects were looked at.
struct Counts {
  std::size_t alike = 0;   ///< As they should be.
  std::size_t absent = 0;  ///< The drive does not have them, so there is nothing to compare.
};

/// One drive while it is looked at: reads its objects, and notes what is not as it should be. Once the drive is silent
/// nothing more is read.
class DriveView {
 public:
  DriveView(const Ask& ask, const config::Drive& drive, config::Findings& findings, Counts& counts)
      : ask_(ask), drive_(drive), findings_(findings), counts_(counts) {}

  [[nodiscard]] const config::Drive& drive() const noexcept { return drive_; }
  [[nodiscard]] bool silent() const noexcept { return silent_; }

  /// Whoever asks for a value looks at its kind; what cannot be read has its finding by then.
  Reading read(canopen::ObjectAddress object, canopen::DataType type, const std::string& name);
  /// Reads it. Where it is not as wanted, `remedy` ends the finding; one that will do (canopen::will_do) is a warning.
  /// Returns what became of the reading.
  Reading::Kind compare(const canopen::SetupItem& item, config::Finding::Level level, const std::string& remedy);
  void as_it_should() noexcept { ++counts_.alike; }
  void note(config::Finding::Level level, const std::string& text);

 private:
  const Ask& ask_;
  const config::Drive& drive_;
  config::Findings& findings_;
  Counts& counts_;
  bool silent_ = false;
};

/// Its place in a finding: `drive "pump1"`.
[[nodiscard]] std::string place_of_drive(const std::string& name);

}  // namespace gateway::compare
