#pragma once

#include <cstdint>

namespace canopen {

// What an SDO client tells or is told by an abort: CiA 301 table 22.
inline constexpr std::uint32_t kAbortToggle = 0x05030000;
inline constexpr std::uint32_t kAbortTimedOut = 0x05040000;
inline constexpr std::uint32_t kAbortCommandUnknown = 0x05040001;
inline constexpr std::uint32_t kAbortBlockSize = 0x05040002;
inline constexpr std::uint32_t kAbortSequenceNumber = 0x05040003;
inline constexpr std::uint32_t kAbortCrc = 0x05040004;
inline constexpr std::uint32_t kAbortOutOfMemory = 0x05040005;
inline constexpr std::uint32_t kAbortLengthMismatch = 0x06070010;
inline constexpr std::uint32_t kAbortGeneral = 0x08000000;

}  // namespace canopen
