#pragma once

#include "canopen/clock.h"

namespace gateway::http {

/// Leaves the loop to the buses: however many clients ask for however much, wording answers takes a quarter of its time
/// at most.
class LoopShare {
 public:
  /// When the next answer may be worded; in the past: now.
  [[nodiscard]] canopen::TimePoint free_at() const noexcept { return free_at_; }
  void note(canopen::TimePoint begin, canopen::TimePoint end) noexcept { free_at_ = end + 3 * (end - begin); }

 private:
  canopen::TimePoint free_at_{};
};

/// Bytes of answers that wait for their clients, of all together.
struct WaitingBytes {
  static constexpr std::size_t kMost = 16UL * 1024 * 1024;
  std::size_t now = 0;
};

}  // namespace gateway::http
