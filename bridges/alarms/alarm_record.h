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
  bool show(std::vector<AlarmError> errors, std::uint8_t error_register, bool confirmed, canopen::WallTime now,
            std::string reason = {});
  /// The same for an alarm that is one condition without a code. `reason`: a word of reason.h, kept when it is over.
  bool show(bool active, std::string reason, std::string text, config::Severity severity, canopen::WallTime now);
  /// The last show() brought a fault that was not there before: an error of its own, or one that was a warning until
  /// then. Another code or text of the same error is none.
  [[nodiscard]] bool fault_began() const noexcept { return fault_began_; }
  /// Alarm::first of the present activation, false until this says otherwise. True where it changed.
  bool set_first(bool first, canopen::WallTime now);
  /// What was known before the gateway's start: an active alarm goes on under its old id.
  void restore(const Alarm& before);
  /// The same, where the drive has told of its errors already: an error still active goes on under its old id, with
  /// its beginning and count. True where it did.
  bool continue_from(const Alarm& before);

 private:
  std::string name_;
  Alarm alarm_;
  bool fault_began_ = false;
};

}  // namespace alarms
