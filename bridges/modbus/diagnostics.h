#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "bridges/process/drive.h"
#include "canopen/clock.h"
#include "config/model.h"

namespace modbus {

/// The block of a drive that is readable whatever its state: 1000..1099.
inline constexpr std::uint16_t kDiagnosticsBegin = 1000;
inline constexpr std::uint16_t kDiagnosticsEnd = 1100;
inline constexpr std::uint16_t kFirstOutRegister = 1016;
inline constexpr std::uint16_t kNmtCommandRegister = 1020;
inline constexpr std::uint16_t kFreshBitsBegin = 1040;
inline constexpr std::size_t kFreshWords = 13;

[[nodiscard]] constexpr bool is_diagnostic(std::uint16_t address) noexcept {
  return address >= kDiagnosticsBegin && address < kDiagnosticsEnd;
}

using Diagnostics = std::array<std::uint16_t, kDiagnosticsEnd - kDiagnosticsBegin>;

/// All of the block but for 1016, 1020 and the fresh bits, which the unit knows. Ages are as of `now`.
[[nodiscard]] Diagnostics diagnostics_of(const process::Drive& drive, config::WordOrder order, canopen::TimePoint now);

}  // namespace modbus
