#pragma once

#include "canopen/bus/bus_state.h"
#include "canopen/frame.h"

namespace canopen::socketcan {

/// The bus' state after the error frame (linux/can/error.h): bus-off, restarted, error-active, warning, passive, and
/// the counters in data[6] (transmit) and data[7] (receive). Frames that tell of something else change nothing.
[[nodiscard]] BusState after_error_frame(const BusState& before, const Frame& frame) noexcept;

/// Of something else than a single error of the wire: of such ones there may be thousands a second, and the counters
/// that come with them are asked for anyway.
[[nodiscard]] bool tells_more_than_an_error(const Frame& frame) noexcept;

/// Nobody acknowledged a frame of ours.
[[nodiscard]] bool tells_no_acknowledge(const Frame& frame) noexcept;

/// The controller's own receive buffer ran over: at least one frame is lost.
[[nodiscard]] bool tells_overrun(const Frame& frame) noexcept;

}  // namespace canopen::socketcan
