#pragma once

#include <array>
#include <cstdint>

#include "canopen/clock.h"
#include "canopen/frame.h"

namespace canopen {

/// What a frame is counted with: its bits on the wire with the usual stuffing, see wire_bits().
[[nodiscard]] std::uint32_t bits_on_wire(const Frame& frame) noexcept;

/// Bits seen in the last second, in tenths of a second.
class BusLoad {
 public:
  void add(const Frame& frame, TimePoint at) noexcept;
  /// Of the ten whole tenths before the current one; at most 1000.
  [[nodiscard]] std::uint16_t per_mille(std::uint32_t bitrate, TimePoint now) noexcept;

 private:
  void move_to(TimePoint now) noexcept;

  static constexpr std::int64_t kSlices = 10;
  std::array<std::uint32_t, kSlices + 1> slices_{};  ///< One more: the current, unfinished one.
  std::int64_t current_ = 0;                         ///< Its number since the clock's zero.
};

}  // namespace canopen
