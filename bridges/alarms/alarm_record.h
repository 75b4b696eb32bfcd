#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "bridges/alarms/alarm.h"
#include "bridges/alarms/alarm_id.h"

namespace alarms {

/// Keeps one alarm: gives it its id, counts, and notes when it came, changed and went. Not known until something is
/// shown or restored.
class AlarmRecord {
 public:
  explicit AlarmRecord(NewId new_id = random_id);

  [[nodiscard]] const Alarm& alarm() const noexcept { return alarm_; }

  /// Shows these errors, oldest first; none: the alarm is over. True where anything changed.
  bool show(std::vector<AlarmError> errors, std::uint8_t error_register, bool confirmed, canopen::WallTime now);
  /// The same for an alarm that is one condition without a code.
  bool show(bool active, std::string text, config::Severity severity, canopen::WallTime now);
  /// As it was before the gateway's start, not confirmed. What is shown next goes on from there: an activation that
  /// lasts keeps id, beginning, count and `first`.
  void restore(const Alarm& before);

 private:
  NewId new_id_;
  Alarm alarm_;
};

}  // namespace alarms
