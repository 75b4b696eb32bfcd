#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "bridges/alarms/alarm.h"

namespace alarms {

/// A fault by the name of its drive or bus; one of the two is empty.
struct NamedFault {
  std::string drive;
  std::string bus;
  AlarmKind kind = AlarmKind::emcy;  ///< Of no meaning for a bus.
  friend bool operator==(const NamedFault&, const NamedFault&) = default;
};

/// What is kept of all alarms over a restart, by names: positions may be others in the next configuration.
struct AlarmMemory {
  struct OfDrive {
    std::string name;
    std::array<std::optional<Alarm>, kAlarmKinds.size()> alarms;  ///< Nothing: not known yet.
    friend bool operator==(const OfDrive&, const OfDrive&) = default;
  };
  struct OfBus {
    std::string name;
    Alarm alarm;
    friend bool operator==(const OfBus&, const OfBus&) = default;
  };

  std::string gateway;  ///< Whose they are, for people.
  std::vector<OfDrive> drives;
  std::vector<OfBus> buses;
  std::optional<NamedFault> newest_first;  ///< The first fault of the newest group.
  friend bool operator==(const AlarmMemory&, const AlarmMemory&) = default;
};

/// As one JSON document, a line for each drive and bus.
[[nodiscard]] std::string memory_text(const AlarmMemory& memory);

/// What memory_text() wrote, or what is wrong with it.
struct ReadMemory {
  AlarmMemory memory;  ///< Empty where something is wrong.
  std::string wrong;   ///< For people. Empty: nothing.
};
/// A document is good as a whole or not at all. Members that are not known are passed over; another version is wrong.
[[nodiscard]] ReadMemory parse_memory(std::string_view text);

}  // namespace alarms
