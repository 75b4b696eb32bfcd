#pragma once

#include <cstdint>
#include <string_view>

namespace canopen {

/// How the newest boot or takeover of a node went: none yet, well, or an error letter of CiA 302-2 (table of boot-up
/// errors) with its ASCII code. The numbers are those of Modbus register 1002. A, G, H and I of that table do not
/// occur: only nodes of the configuration are looked at, and no program is loaded.
enum class BootResult : std::uint8_t {
  ok = 0,
  no_answer = 'B',            ///< No SDO answer at all.
  other_device_type = 'C',    ///< 0x1000.
  other_vendor = 'D',         ///< 0x1018:01.
  no_error_control = 'E',     ///< It runs, and sends neither heartbeat nor guarding answers.
  no_guarding = 'F',          ///< Configured, but it answers no guarding request.
  not_configured = 'J',       ///< A setting could not be made, or see HeldBack.
  no_heartbeat = 'K',         ///< Configured, but its heartbeat does not start.
  left_alone = 'L',           ///< Found operational, or perhaps so, and not as wanted: nothing is changed.
  other_product = 'M',        ///< 0x1018:02.
  other_revision = 'N',       ///< 0x1018:03.
  other_serial_number = 'O',  ///< 0x1018:04.
  not_booted = 255
};

/// Why a node with letter J is not in service, where no setting is the cause.
enum class HeldBack : std::uint8_t {
  no,                ///< A setting could not be made; or it has another letter, or none.
  left_operational,  ///< It left operational by itself.
  found_stopped,     ///< Somebody stopped it before we came.
  start_ignored      ///< It was configured, and NMT start left it as it was.
};

/// Neither well nor unknown: an alarm.
[[nodiscard]] constexpr bool is_letter(BootResult result) noexcept {
  return result != BootResult::ok && result != BootResult::not_booted;
}

/// What a letter means, for people, as in "a setting could not be made"; empty where it is none. The table of
/// docs/CANOPEN.md says the same.
[[nodiscard]] std::string_view text_of(BootResult result, HeldBack held_back = HeldBack::no) noexcept;

/// What whoever is at the plant does first, as in "check its node id"; empty where it is no letter. Likewise.
[[nodiscard]] std::string_view first_steps(BootResult result, HeldBack held_back = HeldBack::no) noexcept;

}  // namespace canopen
