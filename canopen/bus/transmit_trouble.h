#pragma once

#include <cstdint>
#include <optional>

#include "canopen/bus/bus_state.h"
#include "canopen/clock.h"

namespace canopen {

/// What is known of how frames of ours leave.
struct TransmitSigns {
  BusState state{};
  /// Since when none has left, although one was to: handed over without an echo, or not taken (EAGAIN, ENOBUFS).
  std::optional<TimePoint> unsent_since{};
  /// The newest error frame that said that nobody acknowledged; none of ours has left since.
  std::optional<TimePoint> ack_error_at{};
  TimePoint silent_since{};  ///< The newest frame of others, or of ours that was acknowledged; or when the bus came up.
};

/// How long a sign has to last before it is trouble.
inline constexpr Duration kTransmitPatience = std::chrono::seconds(1);
/// How long an error frame about a missing acknowledgement counts, where nothing else says otherwise.
inline constexpr Duration kAckErrorCounts = std::chrono::seconds(10);

/// `now`: what was received before this moment was told. Where nobody else showed itself for a second, nobody
/// acknowledges: an error frame says so, or the controller is error-passive by its transmit errors alone (a missing
/// acknowledgement counts up to there and no further, ISO 11898-1; disturbed wires count received errors, too, or lead
/// to bus-off). Else, where nothing of ours has left for a second, it is stuck. None on a bus that is down or off.
[[nodiscard]] TransmitTrouble judge_transmission(const TransmitSigns& signs, TimePoint now) noexcept;

}  // namespace canopen
