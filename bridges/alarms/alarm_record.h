#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "bridges/alarms/alarm.h"

namespace alarms {

/// Keeps one alarm: gives it its id, counts, and notes when it came, changed and went.
class AlarmRecord {
 public:
  /// `name` makes ids unique beyond this alarm: `pump1-emcy`.
  explicit AlarmRecord(std::string name);

  [[nodiscard]] const Alarm& alarm() const noexcept { return alarm_; }

  /// Shows these errors, oldest first; none: the alarm is over. True where anything changed.
  bool show(std::vector<AlarmError> errors, std::uint8_t error_register, bool confirmed, canopen::WallTime now);
  /// The same for an alarm that is one condition without a code. `reason`: a word of docs/ALARMS.md.
  bool show(bool active, std::string reason, std::string text, config::Severity severity, canopen::WallTime now);
  /// What was known before the gateway's start: an active alarm goes on under its old id.
  void restore(const Alarm& before);
  /// The same, where the drive has told of its errors already: an error still active goes on under its old id, with
  /// its beginning and count. True where it did.
  bool continue_from(const Alarm& before);

 private:
  std::string name_;
  Alarm alarm_;
};

}  // namespace alarms
