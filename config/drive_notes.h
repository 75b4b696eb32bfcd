#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "canopen/object.h"

// What a profile knows of a drive for people: nothing of it changes what the gateway does.

namespace config {

/// One object of the drive that `check --live` looks at: a setting that commands hang on, or the drive's own limit of a
/// signal.
struct LiveCheck {
  canopen::ObjectAddress object;
  canopen::DataType type = canopen::DataType::u16;
  std::string name;    ///< "command source"
  std::string keypad;  ///< "F01.01 = 3 (option card)"; empty: the maker's name of it is not known.
  canopen::Raw mask = ~canopen::Raw{0};
  std::vector<canopen::Raw> equals;  ///< Raw values, masked, that are right. Empty: `limits` is what counts.
  std::string limits;                ///< A signal whose `max` must not be above this object.
  double scale = 1.0;                ///< Of a limit, in the signal's unit.
  std::string signal;                ///< Looked at only where this signal takes commands; empty: always.
  std::string unconfirmed;           ///< What is not established about it; empty: nothing.
  friend bool operator==(const LiveCheck&, const LiveCheck&) = default;
};

/// Values of control_command to try the drive with.
struct Trial {
  std::string setpoint;             ///< A writable signal.
  double value = 0.0;               ///< For it, engineering units.
  std::vector<std::int64_t> run;    ///< One after the other; with the last one goes the setpoint.
  std::vector<std::int64_t> reset;  ///< Of a fault, one after the other.
  friend bool operator==(const Trial&, const Trial&) = default;
};

struct DriveNotes {
  std::vector<LiveCheck> live;
  Trial trial;
  /// An RPDO that is sent, and that the drive trips without (`supervised` and an event timer).
  std::optional<std::uint16_t> supervised_rpdo;
  friend bool operator==(const DriveNotes&, const DriveNotes&) = default;
};

}  // namespace config
