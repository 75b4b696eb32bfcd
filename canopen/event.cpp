#include "canopen/event.h"

#include <algorithm>
#include <boost/asio/redirect_error.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <boost/system/error_code.hpp>
#include <utility>

namespace canopen {
namespace {

/// Keeps a timer in the list of those who wait, as long as the waiting coroutine lives.
class Waiting {
 public:
  Waiting(std::vector<Timer*>& list, Timer& timer) : list_(list), timer_(timer) { list_.push_back(&timer_); }
  ~Waiting() { std::erase(list_, &timer_); }
  Waiting(const Waiting&) = delete;
  Waiting& operator=(const Waiting&) = delete;

 private:
  std::vector<Timer*>& list_;
  Timer& timer_;
};

}  // namespace

Event::Event(boost::asio::any_io_executor executor) : executor_(std::move(executor)) {}

boost::asio::awaitable<void> Event::wait_until(TimePoint until) {
  Timer timer(executor_, until);
  const Waiting waiting(waiting_, timer);
  boost::system::error_code cancelled;  // Both ends of the wait mean the same: look at the state.
  co_await timer.async_wait(boost::asio::redirect_error(boost::asio::use_awaitable, cancelled));
}

void Event::notify() {
  for (Timer* timer : waiting_) {
    timer->cancel();
  }
}

}  // namespace canopen
