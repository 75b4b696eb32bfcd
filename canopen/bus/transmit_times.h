#pragma once

#include <cstdint>
#include <optional>

#include "canopen/clock.h"

namespace canopen {

/// How long a frame may take to leave. Longer at low bit rates, where the frames of others before it take that long.
struct TransmitTimes {
  Duration echo = std::chrono::milliseconds(100);   ///< Without echo by then its outcome is unknown.
  Duration behind = std::chrono::milliseconds(20);  ///< Nothing that moves a motor goes behind one without echo since.

  /// `bitrate` in bit/s; nothing where it is not known.
  [[nodiscard]] static TransmitTimes at(std::optional<std::uint32_t> bitrate) noexcept;
};

}  // namespace canopen
