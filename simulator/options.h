#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "canopen/clock.h"
#include "simulator/motor.h"

namespace simulator {

/// How a simulated drive is built and commissioned. The defaults are those of the manuals, and where these say nothing
/// the strictest for a master.
struct DriveOptions {
  MotorRating motor;
  canopen::Duration boot_time{};              ///< From power-on to the boot-up frame.
  std::optional<std::uint16_t> heartbeat_ms;  ///< 0x1017 at power-on; without a value 0, off.
  /// 0x100C and 0x100D at power-on, as a master has stored them there. Where neither is 0, the first guarding request
  /// starts life guarding.
  std::uint16_t guard_ms = 0;
  std::uint8_t life_factor = 0;
  std::optional<std::uint32_t> serial;  ///< 0x1018:04 of a kind that has 0x1018; without a value its own.
  std::optional<std::uint16_t>
      tpdo_event_ms;                ///< Event timer of its TPDOs at power-on; without a value the kind's own.
  bool veichi_pdo_objects = false;  ///< 0x1400..0x1A07 can be read and written.
  /// Veichi: command and set-point come from the bus (AC300 F00.02 = 2, F00.03 = 6; AC310 F01.01 = 3, F01.02 = 10).
  bool veichi_bus_control = true;
  /// Goodrive600 P15.02..P15.12: the meaning of settings 1..11; 0 invalid, 1 set frequency, ...
  std::array<std::uint16_t, 11> goodrive_settings{1};
  /// Goodrive600 P15.13..P15.23: the meaning of returns 1..11; 0 invalid, 1 running frequency, 2 set frequency, 3 bus
  /// voltage, ...
  std::array<std::uint16_t, 11> goodrive_returns{1, 2, 3};
};

}  // namespace simulator
