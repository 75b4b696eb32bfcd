#pragma once

#include <cstdint>

// How the addresses of a drive are shared out on Modbus. PDU addresses, from 0. What stands at which of them:
// bridges/modbus/addresses.h.

namespace config {

/// Below stand signals that have the same address on every drive; they exist on every unit.
inline constexpr std::uint16_t kCommonAddresses = 200;
/// From 1000 to 1099 stand the diagnostics.
inline constexpr std::uint16_t kDiagnosticsBegin = 1000;
inline constexpr std::uint16_t kDiagnosticsEnd = 1100;
inline constexpr std::uint32_t kAddresses = 65536;

/// Addresses that a drive takes on Modbus::flat_unit, from its base on.
inline constexpr std::uint16_t kFlatBlock = 1000;
/// The first of them are as on its own unit; behind them stand its diagnostics.
inline constexpr std::uint16_t kFlatSignals = 900;

}  // namespace config
