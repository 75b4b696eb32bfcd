#pragma once

#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/io_context.hpp>

#include "canopen/clock.h"

namespace support {

/// An event loop whose time a test moves by hand: hours of protocol in milliseconds, the same way every time.
class HandDrivenLoop {
 public:
  [[nodiscard]] boost::asio::io_context& context() noexcept { return context_; }
  [[nodiscard]] boost::asio::any_io_executor executor() { return context_.get_executor(); }

  /// Runs everything that is due now, until nothing is left to do.
  void settle() {
    while (context_.poll() != 0) {
    }
  }

  /// Moves time on in small steps, settling before and after each, so that timers fire in their order.
  void advance(canopen::Duration by, canopen::Duration step = std::chrono::milliseconds(1)) {
    settle();
    while (by > canopen::Duration::zero()) {
      const canopen::Duration now = by < step ? by : step;
      time_.advance(now);
      by -= now;
      settle();
    }
  }

  /// Advances until `done` says so; false when `limit` passed first.
  template <class Predicate>
  [[nodiscard]] bool advance_until(Predicate done, canopen::Duration limit) {
    settle();
    for (canopen::Duration passed{}; !done(); passed += std::chrono::milliseconds(1)) {
      if (passed >= limit) {
        return false;
      }
      advance(std::chrono::milliseconds(1));
    }
    return true;
  }

 private:
  canopen::ManualTime time_;
  boost::asio::io_context context_{1};
  boost::asio::executor_work_guard<boost::asio::io_context::executor_type> work_{context_.get_executor()};
};

}  // namespace support
