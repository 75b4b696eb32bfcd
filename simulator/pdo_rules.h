#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "canopen/clock.h"

namespace simulator {

/// What makes a TPDO leave.
struct Triggers {
  bool change = false;           ///< Mapped data changed.
  bool timer = false;            ///< The event timer.
  bool rpdo = false;             ///< The RPDO of the same number was received.
  std::uint8_t every_sync = 0;   ///< n: at every n-th SYNC.
  bool changed_at_sync = false;  ///< At a SYNC, if the data changed.
  bool remote = false;           ///< On a remote request.
};

/// Factory settings of one PDO.
struct PdoDefaults {
  bool enabled = true;
  std::uint8_t type = 255;
  std::uint16_t inhibit = 0;
  std::uint16_t event = 0;
  std::vector<std::uint32_t> map;  ///< Entries as in 0x1600 and 0x1A00: index, sub-index, bits.
};

/// How one kind of drive treats its PDOs.
struct PdoRules {
  std::vector<PdoDefaults> transmit;  ///< [0] is TPDO1
  std::vector<PdoDefaults> receive;
  bool objects_present = true;        ///< 0x1400..0x1BFF can be read.
  bool mapping_writable = true;       ///< 0x1600.. and 0x1A00.. can be written.
  bool pre_operational_only = false;  ///< Settings are refused in operational.
  bool strict_procedure = false;      ///< CiA 301: disable before mapping; COB-ID and inhibit only while disabled.
  bool sync_start_value = false;      ///< Sub-index 6 of a TPDO.
  bool rpdo_deadline = false;         ///< Sub-index 5 of an RPDO: its event timer watches over the reception.
  /// The object without which the first PDO of a direction cannot be enabled; 0: none. As a mapping entry.
  std::uint32_t mandatory_transmit = 0;
  std::uint32_t mandatory_receive = 0;
  canopen::Duration inhibit_unit = std::chrono::microseconds(100);  ///< CiA 301
  canopen::Duration inhibit_floor{};                                ///< Shorter inhibit times act as this one.
  bool rpdo_waits_for_sync = true;  ///< RPDO types 0..240 take effect at the next SYNC; else at once.
  bool length_errors = true;        ///< An RPDO shorter than its mapping is reported by EMCY.
  /// Bytes an RPDO must have exactly, [0] for RPDO1; 0: the mapping decides.
  std::array<std::uint8_t, 8> exact_length{};

  /// What a TPDO of this type and event time leaves on; nothing when the combination is not supported.
  std::optional<Triggers> (*triggers)(std::uint8_t number, std::uint8_t type, std::uint16_t event) = nullptr;
};

/// CiA 301 §7.5.2.37: types 0, 1..240, 252..255; 254 and 255 send on change and by the event timer.
[[nodiscard]] std::optional<Triggers> standard_triggers(std::uint8_t number, std::uint8_t type, std::uint16_t event);

}  // namespace simulator
