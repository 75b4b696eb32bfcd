#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/awaitable.hpp>

namespace gateway {

/// Returns when the process is asked to end (SIGINT, SIGTERM).
boost::asio::awaitable<void> stop_signal(boost::asio::any_io_executor executor);

}  // namespace gateway
