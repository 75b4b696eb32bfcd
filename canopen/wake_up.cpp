#include "canopen/wake_up.h"

namespace canopen {

struct WakeUp::State {
  State(const boost::asio::any_io_executor& executor, std::function<void()> to_call)
      : timer(executor), function(std::move(to_call)) {}

  Timer timer;
  std::function<void()> function;
  std::optional<TimePoint> armed;
  std::uint64_t generation = 0;  ///< Tells a handler that was queued before it was moved or cancelled.
};

WakeUp::WakeUp(const boost::asio::any_io_executor& executor, std::function<void()> function)
    : state_(std::make_shared<State>(executor, std::move(function))) {}

WakeUp::~WakeUp() {
  cancel();
}

void WakeUp::arm(TimePoint at) {
  state_->armed = at;
  state_->timer.expires_at(at);
  state_->timer.async_wait([weak = std::weak_ptr(state_), generation = ++state_->generation](const auto& error) {
    const std::shared_ptr<State> state = weak.lock();
    if (error || !state || state->generation != generation) {
      return;
    }
    state->armed.reset();
    state->function();
  });
}

void WakeUp::arm_no_later_than(TimePoint at) {
  if (!state_->armed || at < *state_->armed) {
    arm(at);
  }
}

void WakeUp::cancel() {
  ++state_->generation;
  state_->armed.reset();
  state_->timer.cancel();
}

}  // namespace canopen
