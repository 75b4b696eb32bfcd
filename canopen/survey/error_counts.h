#pragma once

#include <cstdint>
#include <string>

#include "canopen/frame.h"

namespace canopen {

/// Error frames of the driver by what they tell of the wire. One frame may tell several kinds.
struct ErrorCounts {
  std::uint32_t bit = 0;    ///< Sent one level, saw the other.
  std::uint32_t stuff = 0;  ///< Six equal bits.
  std::uint32_t form = 0;
  std::uint32_t crc = 0;
  std::uint32_t ack = 0;   ///< Nobody acknowledged a frame of ours.
  std::uint32_t wire = 0;  ///< Frames that tell of any but `ack`.

  ErrorCounts& operator+=(const ErrorCounts& other) noexcept;
  friend bool operator==(const ErrorCounts&, const ErrorCounts&) = default;
};

/// What one error frame (linux/can/error.h) tells. Changes of the controller's state, overruns and lost arbitration are
/// no errors of the wire.
[[nodiscard]] ErrorCounts error_counts_of(const Frame& error) noexcept;

/// `31 form, 26 stuff`; the most first. Empty where there are none.
[[nodiscard]] std::string text_of(const ErrorCounts& counts);

}  // namespace canopen
