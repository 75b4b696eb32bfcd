#include "bridges/mqtt/backoff.h"

#include <algorithm>

namespace mqtt {

std::chrono::milliseconds Backoff::next() {
  constexpr unsigned kMaxStep = 20;
  const std::chrono::milliseconds whole = std::min(std::chrono::milliseconds(first_ * (1LL << step_)), longest_);
  step_ = std::min(step_ + 1, kMaxStep);
  std::uniform_int_distribution<std::chrono::milliseconds::rep> shorten(0, whole.count() / 2);
  return whole - std::chrono::milliseconds(shorten(random_));
}

}  // namespace mqtt
