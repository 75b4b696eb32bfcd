#pragma once

#include <cstdint>
#include <string>
#include <utility>

#include "canopen/sdo/frames.h"

namespace canopen {

/// What a frame of the server, or the departure of one of ours, means to a transfer.
enum class SdoStep : std::uint8_t {
  ignored,    ///< Not for this transfer; of a departure: now an answer is due.
  taken,      ///< Accepted; nothing is to be sent, more is to come.
  more,       ///< A request is to be sent.
  completed,  ///< Data confirmed or complete.
  failed      ///< Why is told.
};

/// A step of a part of a transfer.
struct SdoReaction {
  SdoStep step = SdoStep::ignored;
  SdoFrame request{};            ///< Of `more`.
  std::string why{};             ///< Of `failed`,
  std::uint32_t abort_code = 0;  ///< and what the server is told; 0: nothing.
};

[[nodiscard]] inline SdoReaction failed(std::string why, std::uint32_t abort_code) {
  return {.step = SdoStep::failed, .why = std::move(why), .abort_code = abort_code};
}

/// Of sub-blocks in a row of which nothing got through: more never will.
inline constexpr unsigned kMostWithoutAny = 3;

}  // namespace canopen
