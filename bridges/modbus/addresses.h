#pragma once

#include <cstddef>
#include <cstdint>

#include "config/address_map.h"

// Where things stand in the register maps. PDU addresses, from 0.

namespace modbus {

// Of a drive's unit. Addresses without a signal below kCommonAddresses read 0, so that a client may read the common
// block in one go whatever the drive.
using config::kCommonAddresses;
using config::kDiagnosticsBegin;
using config::kDiagnosticsEnd;

/// Where the drives of a plant differ in 101..103, 100..103 can still be written in one request.
inline constexpr std::uint16_t kControlRegister = 100;
inline constexpr std::uint16_t kLastBesideIt = 103;

inline constexpr std::uint16_t kFirstOutRegister = 1016;
inline constexpr std::uint16_t kNmtCommandRegister = 1020;
inline constexpr std::uint16_t kFreshBitsBegin = 1040;
inline constexpr std::size_t kFreshWords = 13;

[[nodiscard]] constexpr bool is_diagnostic(std::uint16_t address) noexcept {
  return address >= kDiagnosticsBegin && address < kDiagnosticsEnd;
}

// Of the gateway's units, 0 and 255.

/// Any value but 0 written there by function 6 or 16 is a stop for all.
inline constexpr std::uint16_t kStopRegister = 20;
/// One block for each bus, in their order.
inline constexpr std::uint16_t kBusBlockBegin = 100;
inline constexpr std::uint16_t kBusBlockSize = 20;

// Of a drive's block on the flat unit, counted from its base.
using config::kFlatBlock;
using config::kFlatSignals;

}  // namespace modbus
