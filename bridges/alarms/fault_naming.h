#pragma once

#include <cstdint>
#include <optional>

#include "bridges/alarms/alarm.h"
#include "canopen/node/emcy.h"
#include "config/model.h"

namespace alarms {

/// Text and severity of an emergency: by the drive's own code where the layout carries one, else by the EMCY code or
/// its CiA 301 class, else the bare number. Never one for a reset.
[[nodiscard]] config::FaultText name_emcy(const config::FaultRules& rules, const canopen::EmcySettings& settings,
                                          const canopen::Emcy& emcy);

/// The fault code signal holds EMCY codes, as 0x603F of a CiA 402 drive; all others number their faults themselves.
[[nodiscard]] bool is_emcy_code(const config::FaultRules& rules, const canopen::EmcySettings& settings,
                                std::uint64_t code) noexcept;

/// The same for the value of the profile's fault code signal; the severity is that of the status bit that told it.
[[nodiscard]] config::FaultText name_fault_code(const config::FaultRules& rules, const canopen::EmcySettings& settings,
                                                std::uint64_t code, config::Severity severity);

/// The same for an entry of object 0x1003, whose low half is an EMCY code (CiA 301 §7.5.2.4).
[[nodiscard]] config::FaultText name_history_code(const config::FaultRules& rules,
                                                  const canopen::EmcySettings& settings, std::uint16_t code,
                                                  config::Severity severity);

/// The drive's own number of an error, where the layout has one in its EMCY code and vendor bytes.
[[nodiscard]] std::optional<std::uint64_t> drive_code_of(const canopen::EmcySettings& settings,
                                                         const AlarmError& error);

}  // namespace alarms
