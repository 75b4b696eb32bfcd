#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/awaitable.hpp>
#include <cstddef>
#include <functional>

#include "canopen/clock.h"

namespace net {

/// Coroutines whose owner waits for their end before it goes itself. One loop, one thread.
class Tasks {
 public:
  explicit Tasks(boost::asio::any_io_executor executor);
  Tasks(const Tasks&) = delete;
  Tasks& operator=(const Tasks&) = delete;

  /// Runs `work`; then `ended` is called. What `work` throws goes on to the loop.
  void spawn(boost::asio::awaitable<void> work, std::function<void()> ended = nullptr);
  /// Returns when none runs any more.
  boost::asio::awaitable<void> all_ended();
  [[nodiscard]] bool none_runs() const noexcept { return running_ == 0; }

 private:
  boost::asio::any_io_executor executor_;
  canopen::Timer none_runs_;
  std::size_t running_ = 0;
};

}  // namespace net
