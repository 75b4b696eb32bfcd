#pragma once

#include <array>
#include <cstdint>
#include <functional>

#include "canopen/bus/handler_list.h"
#include "canopen/bus/link.h"
#include "canopen/bus/subscription.h"
#include "canopen/frame.h"

namespace canopen {

/// Hands received frames to those who subscribed to their COB-ID: one slot for each of the 2 048 identifiers, so
/// finding a handler costs one array access and nothing is allocated per frame.
class Dispatch {
 public:
  using Handler = std::function<void(const Received&)>;

  /// Throws std::invalid_argument for a COB-ID beyond 0x7FF. Outlives its subscriptions.
  [[nodiscard]] Subscription subscribe(std::uint32_t cob_id, Handler handler);

  /// Error frames, remote requests and 29-bit identifiers reach nobody: their low bits would read as a COB-ID.
  void deliver(const Received& received);

 private:
  std::array<HandlerList<const Received&>, kMaxCobId + 1> slots_;
};

}  // namespace canopen
