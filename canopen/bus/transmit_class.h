#pragma once

#include <cstdint>

namespace canopen {

/// What a frame is for. Lower ones leave first, whatever their COB-ID: by COB-ID alone the SDO requests of many booting
/// drives keep our heartbeat back, which has the highest one, and with it every stop by SDO.
enum class TransmitClass : std::uint8_t {
  stop,        ///< RPDOs and SDO downloads that stop a motor.
  nmt,         ///< NMT commands.
  control,     ///< SYNC, our heartbeat, guarding requests.
  command,     ///< RPDOs and SDO downloads that somebody asked for.
  repetition,  ///< Confirmed RPDOs again.
  sdo          ///< All other SDO frames, first come first served.
};

[[nodiscard]] constexpr bool is_command(TransmitClass transmit_class) noexcept {
  return transmit_class == TransmitClass::stop || transmit_class == TransmitClass::nmt ||
         transmit_class == TransmitClass::command;
}

/// What can move a motor, or stop it.
[[nodiscard]] constexpr bool is_motion(TransmitClass transmit_class) noexcept {
  return is_command(transmit_class) || transmit_class == TransmitClass::repetition;
}

/// How the wait for a frame's departure ended.
enum class Departure : std::uint8_t {
  left,       ///< Its echo came back.
  withdrawn,  ///< Its time passed, or it was withdrawn, before the kernel had it: it can never leave.
  unknown,    ///< The kernel had it, and no echo came in time.
  offline     ///< The bus is down, or takes no command until an echo returns.
};

}  // namespace canopen
