#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <functional>
#include <memory>
#include <optional>

#include "canopen/clock.h"

namespace canopen {

/// Calls a function once at a time that may be moved. The function is never called after the object is gone, although
/// Asio may already hold the expired timer's handler by then. It may arm the timer again, but not destroy it.
class WakeUp {
 public:
  WakeUp(const boost::asio::any_io_executor& executor, std::function<void()> function);
  ~WakeUp();
  WakeUp(const WakeUp&) = delete;
  WakeUp& operator=(const WakeUp&) = delete;

  /// Calls at `at`, or at once through the loop when that has passed; replaces what was armed.
  void arm(TimePoint at);
  /// Does nothing while armed for an earlier moment: waking up too early is cheaper than moving the timer per frame.
  void arm_no_later_than(TimePoint at);
  void cancel();

 private:
  struct State;
  std::shared_ptr<State> state_;
};

}  // namespace canopen
