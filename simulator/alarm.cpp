#include "simulator/alarm.h"

#include <boost/system/error_code.hpp>
#include <utility>

namespace simulator {

Alarm::Alarm(const boost::asio::any_io_executor& executor, std::function<void()> action)
    : timer_(executor), action_(std::move(action)) {}

void Alarm::start(canopen::Duration after) {
  period_ = canopen::Duration::zero();
  wait_until(canopen::Clock::now() + after);
}

void Alarm::repeat(canopen::Duration period) {
  period_ = period;
  wait_until(canopen::Clock::now() + period);
}

void Alarm::stop() noexcept {
  ++*generation_;
  running_ = false;
}

void Alarm::wait_until(canopen::TimePoint at) {
  running_ = true;
  const std::uint64_t mine = ++*generation_;
  timer_.expires_at(at);
  timer_.async_wait([this, at, mine, generation = std::weak_ptr(generation_)](const boost::system::error_code& error) {
    const auto current = generation.lock();
    if (!error && current && *current == mine) {
      expire(at);
    }
  });
}

void Alarm::expire(canopen::TimePoint at) {
  if (period_ > canopen::Duration::zero()) {
    // A loop that was held up for long does not catch up with a burst.
    const canopen::TimePoint now = canopen::Clock::now();
    const canopen::TimePoint next = at + period_;
    wait_until(next > now ? next : now + period_);
  } else {
    running_ = false;
  }
  action_();
}

}  // namespace simulator
