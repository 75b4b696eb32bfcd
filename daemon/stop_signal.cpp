#include "daemon/stop_signal.h"

#include <boost/asio/redirect_error.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <csignal>

namespace gateway {

StopSignal::StopSignal(const boost::asio::any_io_executor& executor, HangUp hang_up)
    : signals_(executor, SIGINT, SIGTERM) {
  struct sigaction now{};
  const bool outlives = ::sigaction(SIGHUP, nullptr, &now) == 0 && now.sa_handler == SIG_IGN;
  if (hang_up == HangUp::ends_it && !outlives) {
    signals_.add(SIGHUP);
  }
}

void StopSignal::stop() {
  stopped_ = true;
  signals_.cancel();
}

boost::asio::awaitable<void> StopSignal::wait() {
  boost::system::error_code ignored;  // Only stop() cancels it, and that ends the waiting too.
  if (!stopped_) {
    co_await signals_.async_wait(boost::asio::redirect_error(boost::asio::use_awaitable, ignored));
  }
  signals_.clear(ignored);
}

}  // namespace gateway
