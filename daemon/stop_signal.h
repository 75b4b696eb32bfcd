#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/awaitable.hpp>
#include <boost/asio/signal_set.hpp>

namespace gateway {

/// What ends a command that runs until it is told: SIGINT, SIGTERM, or the command itself. A signal that comes before
/// anybody waits is kept.
class StopSignal {
 public:
  explicit StopSignal(const boost::asio::any_io_executor& executor);

  /// Ends wait() as a signal would.
  void stop();
  /// A further signal after that ends the program at once.
  boost::asio::awaitable<void> wait();

 private:
  boost::asio::signal_set signals_;
  bool stopped_ = false;
};

}  // namespace gateway
