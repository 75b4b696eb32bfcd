#include "daemon/http/loop_share.h"

#include <algorithm>

namespace gateway::http {

void LoopShare::enter(canopen::Timer& wake, const boost::asio::ip::address& from) {
  std::erase_if(next_, [this](const auto& one) { return one.second <= round_; });
  const auto next = next_.find(from);
  const std::uint64_t round = next == next_.end() ? round_ : next->second;
  next_[from] = round + 1;
  waiting_.insert(std::ranges::upper_bound(waiting_, round, {}, &Waiter::round), {&wake, round});
}

void LoopShare::leave(const canopen::Timer& wake) {
  const auto found = std::ranges::find(waiting_, &wake, &Waiter::wake);
  if (found == waiting_.end()) {
    return;
  }
  if (found == waiting_.begin()) {
    round_ = found->round;
  }
  waiting_.erase(found);
  if (!waiting_.empty()) {
    waiting_.front().wake->cancel();
  }
}

}  // namespace gateway::http
