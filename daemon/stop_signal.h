#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/awaitable.hpp>
#include <boost/asio/signal_set.hpp>
#include <cstdint>

namespace gateway {

/// What ends a command that runs until it is told: SIGINT, SIGTERM, or the command itself. A signal that comes before
/// anybody waits is kept.
class StopSignal {
 public:
  /// What the end of its terminal (SIGHUP) is to a command.
  enum class HangUp : std::uint8_t {
    no_matter,
    ends_it  ///< Unless it was started to outlive it, as by nohup.
  };
  explicit StopSignal(const boost::asio::any_io_executor& executor, HangUp hang_up = HangUp::no_matter);

  /// Ends wait() as a signal would.
  void stop();
  /// A further signal after that ends the program at once.
  boost::asio::awaitable<void> wait();

 private:
  boost::asio::signal_set signals_;
  bool stopped_ = false;
};

}  // namespace gateway
