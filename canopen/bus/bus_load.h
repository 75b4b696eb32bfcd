#pragma once

#include <array>
#include <cstdint>

#include "canopen/clock.h"
#include "canopen/frame.h"

namespace canopen {

/// What a frame is counted with: its bits on the wire with the usual stuffing, see wire_bits().
[[nodiscard]] std::uint32_t bits_on_wire(const Frame& frame) noexcept;

/// A request or an answer of the default SDO channel (CiA 301 table 75).
[[nodiscard]] constexpr bool is_sdo(const Frame& frame) noexcept {
  return !frame.extended && frame.id > 0x580 && frame.id < 0x680 && frame.id != 0x600;
}

/// Bits seen in the last second, in tenths of a second.
class BusLoad {
 public:
  void add(const Frame& frame, TimePoint at) noexcept;
  /// Of the ten whole tenths before the current one; at most 1000.
  [[nodiscard]] std::uint16_t per_mille(std::uint32_t bitrate, TimePoint now) noexcept;
  /// The highest that per_mille() could have told so far.
  [[nodiscard]] std::uint16_t highest_per_mille(std::uint32_t bitrate, TimePoint now) noexcept;
  /// per_mille() without SDO.
  [[nodiscard]] std::uint16_t others_per_mille(std::uint32_t bitrate, TimePoint now) noexcept;

 private:
  struct Bits {
    std::uint32_t sdo = 0;
    std::uint32_t others = 0;
  };
  void move_to(TimePoint now) noexcept;
  [[nodiscard]] Bits of_whole_slices() const noexcept;

  static constexpr std::int64_t kSlices = 10;
  std::array<Bits, kSlices + 1> slices_{};  ///< One more: the current, unfinished one.
  std::int64_t current_ = 0;                ///< Its number since the clock's zero.
  std::uint64_t highest_ = 0;               ///< Bits of the busiest second.
};

}  // namespace canopen
