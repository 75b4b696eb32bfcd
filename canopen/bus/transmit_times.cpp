#include "canopen/bus/transmit_times.h"

#include <algorithm>

namespace canopen {
namespace {

constexpr std::uint32_t kLongestFrame = 135;  // Bits: 8 bytes of data and the worst stuffing (ISO 11898-1).
// How many frames of others may go before one of ours. More than that keep a bus busy for good.
constexpr int kFramesBeforeEcho = 32;
constexpr int kFramesBeforeStuck = 6;

}  // namespace

TransmitTimes TransmitTimes::at(std::optional<std::uint32_t> bitrate) noexcept {
  TransmitTimes times;
  if (bitrate && *bitrate > 0) {
    const Duration frame = std::chrono::nanoseconds(std::nano::den * kLongestFrame / *bitrate);
    times.echo = std::max(times.echo, kFramesBeforeEcho * frame);
    times.behind = std::max(times.behind, kFramesBeforeStuck * frame);
  }
  return times;
}

}  // namespace canopen
