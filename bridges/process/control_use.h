#pragma once

#include <cstdint>

namespace process {

/// What a command, or a value that the drive holds by it, does with `control_command`.
enum class ControlUse : std::uint8_t {
  none,       ///< Does not write it: set-points, NMT, raw SDO.
  run,        ///< A value that is neither of the other two: the motor may turn.
  momentary,  ///< A value that the profile marks so (fault reset, jog): neither a stop nor awaited to run.
  stop        ///< A value of the profile's `stop` or `stop_masks`.
};

}  // namespace process
