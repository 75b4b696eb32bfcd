#include "canopen/survey/recent_traffic.h"

namespace canopen {

void RecentTraffic::pass(std::size_t seconds) noexcept {
  for (std::size_t i = 0; i < seconds && i < seconds_.size(); ++i) {
    current_ = (current_ + 1) % seconds_.size();
    seconds_[current_] = {};
  }
}

RecentTraffic::Sum RecentTraffic::of_last(std::size_t seconds) const noexcept {
  Sum sum;
  for (std::size_t back = 0; back <= seconds && back < seconds_.size(); ++back) {
    const Sum& second = seconds_[(current_ + seconds_.size() - back) % seconds_.size()];
    sum.errors += second.errors;
    sum.received += second.received;
  }
  return sum;
}

}  // namespace canopen
