#pragma once

#include <cstdint>

#include "canopen/bus/link.h"

namespace canopen {

/// Whose frame it is.
enum class FrameOrigin : std::uint8_t {
  others,
  ourselves,  ///< It came back: it has left.
  driver      ///< An error frame, which was never on the wire.
};

/// Sees every frame of a bus in the order of reception, before anybody acts on it. It only looks: it must not call the
/// bus, nor end or begin a tap, from inside.
class FrameTap {
 public:
  virtual void on_frame(const Received& frame, FrameOrigin origin) = 0;
  /// So many were lost before the next one.
  virtual void on_frames_lost(std::uint32_t count) = 0;

 protected:
  ~FrameTap() = default;
};

}  // namespace canopen
