#pragma once

#include <cmath>
#include <cstdint>

namespace simulator {

/// A reading as an integer object carries it: `value` in units of 1/scale, negative ones as two's complement.
[[nodiscard]] inline std::uint32_t scaled(double value, double scale) noexcept {
  return static_cast<std::uint32_t>(static_cast<std::int32_t>(std::lround(value * scale)));
}

}  // namespace simulator
