#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/awaitable.hpp>
#include <vector>

#include "canopen/clock.h"

namespace canopen {

/// How coroutines wait for a state: the one who changes the state calls notify(), the waiting one looks at the state
/// again. It carries no state itself, so no notification can be missed or be too old.
/// Outlives its waiters.
class Event {
 public:
  explicit Event(boost::asio::any_io_executor executor);
  ~Event() = default;
  Event(const Event&) = delete;
  Event& operator=(const Event&) = delete;

  /// Returns after the next notify(), at the latest at `until`.
  boost::asio::awaitable<void> wait_until(TimePoint until);
  /// Wakes all who wait, through the loop.
  void notify();

 private:
  boost::asio::any_io_executor executor_;
  std::vector<Timer*> waiting_;
};

}  // namespace canopen
