#include "daemon/stop_signal.h"

#include <boost/asio/signal_set.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <csignal>

namespace gateway {

boost::asio::awaitable<void> stop_signal(boost::asio::any_io_executor executor) {
  boost::asio::signal_set signals(executor, SIGINT, SIGTERM);
  co_await signals.async_wait(boost::asio::use_awaitable);
}

}  // namespace gateway
