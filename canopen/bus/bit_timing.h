#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace canopen {

/// What a CAN controller is set up with, as its driver tells it.
struct BitTiming {
  std::uint32_t bitrate = 0;       ///< bit/s
  std::uint16_t sample_point = 0;  ///< Per mille of a bit.
  std::uint32_t restart_ms = 0;    ///< After a bus-off it begins again after so many ms; 0: never by itself.
  friend bool operator==(const BitTiming&, const BitTiming&) = default;
};

/// For people: `250000 bit/s, sample point 87.5 %, restart-ms 100`.
[[nodiscard]] std::string describe(const BitTiming& timing);

/// For people: what of it will be regretted, with the remedy. `stated`: the bit rate of the configuration, in bit/s.
[[nodiscard]] std::vector<std::string> doubts_about(const BitTiming& timing, std::optional<std::uint32_t> stated);

}  // namespace canopen
