#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "canopen/clock.h"
#include "canopen/frame.h"
#include "simulator/object_dictionary.h"

namespace simulator {

/// How a drive spoils its SDO answers.
enum class SdoFlaw : std::uint8_t {
  none,
  foreign_index,      ///< The answer names the next index.
  foreign_sub_index,  ///< The answer names the next sub-index.
  wrong_toggle,       ///< Segment answers carry the other toggle bit; others are left alone.
  unknown_command,    ///< A command specifier CiA 301 does not know.
  abort               ///< Every request is refused with `abort_code`.
};

/// An object that the drive denies to have, or one sub-index of it.
struct AbsentObject {
  std::uint16_t index = 0;
  std::optional<std::uint8_t> sub;  ///< Without a value: the whole object.
};

/// What is wrong with a drive, on request. Everything off: the drive behaves.
struct Misbehaviour {
  bool mute = false;               ///< Sends nothing, still hears.
  bool unplugged = false;          ///< Neither sends nor hears, as if its cable were pulled.
  bool heartbeat_stopped = false;  ///< No heartbeat and no guarding answer.
  bool boot_up_missing = false;    ///< Sends no boot-up frame.
  bool toggle_stuck = false;       ///< The toggle bit of guarding answers stays 0.

  canopen::Duration sdo_delay{};  ///< Between request and answer.
  bool sdo_short = false;         ///< Answers are cut to the bytes they need.
  SdoFlaw sdo_flaw = SdoFlaw::none;
  std::uint32_t abort_code = 0x08000000;    ///< For SdoFlaw::abort.
  std::optional<std::uint32_t> flaws_left;  ///< Answers still to be spoilt; without a value: all.
  std::uint32_t sdo_drops_left = 0;         ///< Requests still to be left without an answer.
  /// The abort code by which SDO writes to objects of an enabled RPDO are refused; without a value they are taken.
  std::optional<std::uint32_t> pdo_only;
  /// Controlled at its keypad: RPDOs are received and watched, but have no effect; SDO writes to their objects are
  /// refused (0x08000021).
  bool local = false;

  std::vector<AbsentObject> absent;  ///< SDO requests to them are refused. PDOs carry them as before.
  /// What 0x1014 holds after each start of the drive, as if it had been stored so; without a value 0x80 + node.
  std::optional<std::uint32_t> emcy_id;

  std::optional<std::uint8_t> tpdo_length;       ///< 0..8: every TPDO is cut or filled with zeros to it.
  std::optional<std::uint8_t> sdo_length;        ///< The same for SDO answers.
  std::optional<std::uint8_t> heartbeat_length;  ///< The same for heartbeats and boot-up frames.
  std::optional<std::uint8_t> emcy_length;       ///< The same for EMCY.
};

/// Why the drive denies to have the object; `none` where it does not.
[[nodiscard]] Abort denial(const Misbehaviour& misbehaviour, Address address);

/// `frame` with `length` data bytes, cut or filled with zeros.
[[nodiscard]] canopen::Frame with_length(const canopen::Frame& frame, std::optional<std::uint8_t> length);

/// The SDO answer as the drive's misbehaviour has it; counts down `flaws_left`.
[[nodiscard]] canopen::Frame spoil_sdo_answer(const canopen::Frame& request, canopen::Frame answer,
                                              Misbehaviour& misbehaviour);

}  // namespace simulator
