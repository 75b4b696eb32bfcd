#include "canopen/node/heartbeat_consumer.h"

#include <algorithm>
#include <utility>

namespace canopen {
namespace {

constexpr std::uint8_t kStateMask = 0x7F;

NmtState state_of(std::uint8_t number) noexcept {
  switch (number) {
    case 4:
      return NmtState::stopped;
    case 5:
      return NmtState::operational;
    case 127:
      return NmtState::pre_operational;
    default:
      return NmtState::unknown;
  }
}

}  // namespace

std::optional<HeartbeatMessage> decode_heartbeat(std::span<const std::uint8_t> bytes) noexcept {
  if (bytes.empty()) {
    return std::nullopt;
  }
  if (bytes[0] == 0) {
    return HeartbeatMessage{true, NmtState::initialising};
  }
  return HeartbeatMessage{false, state_of(bytes[0] & kStateMask)};
}

HeartbeatConsumer::HeartbeatConsumer(const boost::asio::any_io_executor& executor, Duration timeout,
                                     std::function<void()> on_silence, MayStillHear may_still_hear)
    : timeout_(timeout),
      limit_(timeout),
      on_silence_(std::move(on_silence)),
      may_still_hear_(std::move(may_still_hear)),
      wake_up_(executor, [this] { look(); }) {}

void HeartbeatConsumer::watch(TimePoint from, Duration at_least) {
  if (timeout_ <= Duration::zero()) {
    return;
  }
  last_ = from;
  first_loss_.reset();
  watching_ = true;
  limit_ = std::max(timeout_, at_least);
  wake_up_.arm(last_ + limit_);
}

void HeartbeatConsumer::suspend() {
  watching_ = false;
  wake_up_.cancel();
}

void HeartbeatConsumer::alive(TimePoint at) noexcept {
  last_ = std::max(last_, at);
  first_loss_.reset();
}

void HeartbeatConsumer::frames_lost(TimePoint now) noexcept {
  first_loss_ = first_loss_.value_or(now);
  last_ = std::max(last_, std::min(now, *first_loss_ + limit_));
}

// The timer runs to the end that was right when it was armed; messages since then have moved that end.
void HeartbeatConsumer::look() {
  if (!watching_) {
    return;
  }
  const TimePoint end = last_ + limit_;
  if (may_still_hear_(end)) {
    wake_up_.arm(or_soon(end));
    return;
  }
  watching_ = false;
  on_silence_();
}

}  // namespace canopen
