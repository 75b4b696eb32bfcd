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
  /// `severity`: of one that was never active.
  explicit AlarmRecord(NewId new_id = random_id, config::Severity severity = config::Severity::fault);

  [[nodiscard]] const Alarm& alarm() const noexcept { return alarm_; }

  /// Shows these errors, oldest first; none: the alarm is over. True where anything changed.
  bool show(std::vector<AlarmError> errors, std::uint8_t error_register, bool confirmed, canopen::WallTime now,
            std::string reason = {});
  /// The same for an alarm that is one condition without a code. `reason`: a word of reason.h, kept when it is over.
  bool show(bool active, std::string reason, std::string text, config::Severity severity, canopen::WallTime now);
  /// The last show() brought a fault that was not there before: an error of its own, or one that was a warning until
  /// then. Another code or text of the same error is none.
  [[nodiscard]] bool fault_began() const noexcept { return fault_began_; }
  /// Alarm::first of the present activation, false until this says otherwise. True where it changed.
  bool set_first(bool first, canopen::WallTime now);
  /// Alarm::record of the present activation, or of the last one. That alone is no change of it: `ts` stays. True where
  /// it is another name now.
  bool set_record(std::string name);
  /// As it was before the gateway's start, not confirmed. What is shown next goes on from there: an activation that
  /// lasts keeps id, beginning, count and `first`.
  void restore(const Alarm& before);

 private:
  NewId new_id_;
  Alarm alarm_;
  bool fault_began_ = false;
};

}  // namespace alarms
