#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "bridges/alarms/alarm.h"
#include "bridges/recorder/frame_ring.h"
#include "bridges/recorder/record_name.h"
#include "canopen/clock.h"

namespace recorder {

/// An alarm that began while the record was made.
struct RecordedAlarm {
  static constexpr std::size_t kMostErrors = 100;

  std::string drive;                        ///< Empty: of the bus.
  std::optional<alarms::AlarmKind> kind{};  ///< Of a drive.
  /// As it began, with every error that came until the end. `first` stays where the fault is over or became a warning
  /// of the same activation; it goes only where another fault turns out to have come before.
  alarms::Alarm alarm;
  alarms::Alarm at_end;  ///< As it last was.

  /// It is like this now; an alarm of the same id.
  void change(alarms::Alarm now);
};

/// All that is written of one record. It is its own: another thread may have it.
struct Record {
  static constexpr std::size_t kMostAlarms = 200;

  RecordName name;
  std::string bus;
  std::string interface;                   ///< As logs name it: config::log_interface().
  std::optional<std::uint32_t> bitrate{};  ///< As the configuration says.
  std::string drive{};                     ///< Whose fault it is of; empty: of the bus.
  std::string requested_by{};              ///< The user; empty: a fault.
  canopen::WallTime from{};                ///< Frames since,
  canopen::WallTime until{};               ///< and up to then.
  std::string ended{};                     ///< Why it ended before its time; empty: it did not.
  FrameSlice frames{};
  std::vector<RecordedAlarm> alarms{};  ///< In the order in which they began; the first is the cause.
  std::size_t alarms_left_out = 0;
  std::vector<std::string> commands{};  ///< JSON objects, see command_text().
  std::size_t commands_left_out = 0;

  /// One of its faults came first.
  [[nodiscard]] bool first() const noexcept {
    for (const RecordedAlarm& alarm : alarms) {
      if (alarm.alarm.first) {
        return true;
      }
    }
    return false;
  }
};

}  // namespace recorder
