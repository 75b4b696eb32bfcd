#pragma once

#include <optional>
#include <vector>

#include "bridges/process/drive.h"
#include "canopen/clock.h"

namespace modbus {

/// Which command registers hold a value that a mask write (function 22) may build upon: it keeps the bits that the
/// client did not name, so these must be bits that somebody commanded and that still stand. They do not any more after
/// the drive booted, was lost, left operational, came to a stop, began a quick stop, or a fault came or went: a mask
/// write must never carry a run command from before.
class KnownCommands {
 public:
  explicit KnownCommands(const config::Drive& drive);

  /// Looks at the drive; to be called whenever anything of it changed.
  void observe(const process::Drive& drive, canopen::TimePoint now);

  void confirm(process::SignalId signal, canopen::Raw raw, canopen::TimePoint now);
  /// Nobody knows any more what stands.
  void forget(process::SignalId signal, canopen::TimePoint now);
  /// When the value that stands was confirmed; nothing where none stands.
  [[nodiscard]] std::optional<canopen::TimePoint> confirmed_at(process::SignalId signal) const;
  /// What was read from the drive by then may have been overwritten since by a command of unknown outcome.
  [[nodiscard]] std::optional<canopen::TimePoint> forgotten_at(process::SignalId signal) const;

 private:
  struct Seen {
    bool operational = false;
    bool running = false;
    bool quick_stop = false;
    bool fault = false;
    std::uint16_t boot_ups = 0;
  };

  const config::Drive& drive_;
  std::vector<std::optional<canopen::TimePoint>> confirmed_;
  std::vector<std::optional<canopen::TimePoint>> forgotten_;
  Seen seen_;
};

}  // namespace modbus
