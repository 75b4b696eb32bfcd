#pragma once

#include <cstddef>
#include <deque>

#include "canopen/clock.h"

namespace gateway::http {

/// Leaves the loop to the buses: however many clients ask for however much, wording answers takes a quarter of its time
/// at most. They have their turn in the order in which they came.
class LoopShare {
 public:
  /// `wake` is what the client waits with, until it leaves. One that must wait does so until when() it says, and asks
  /// again then, and when its wait is cancelled.
  void enter(canopen::Timer& wake) { waiting_.push_back(&wake); }
  /// When this one has its turn; in the past: now.
  [[nodiscard]] canopen::TimePoint when(const canopen::Timer& wake) const noexcept {
    return waiting_.front() == &wake ? free_at_ : canopen::kNever;
  }
  /// It had its turn, or wants none any more.
  void leave(const canopen::Timer& wake) {
    std::erase(waiting_, &wake);
    if (!waiting_.empty()) {
      waiting_.front()->cancel();
    }
  }
  /// An answer was worded.
  void note(canopen::TimePoint begin, canopen::TimePoint end) noexcept { free_at_ = end + 3 * (end - begin); }

 private:
  std::deque<canopen::Timer*> waiting_;
  canopen::TimePoint free_at_{};
};

/// Bytes of answers that wait for their clients, of all together.
struct WaitingBytes {
  static constexpr std::size_t kMost = 16UL * 1024 * 1024;
  std::size_t now = 0;
};

}  // namespace gateway::http
