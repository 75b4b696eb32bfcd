#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <cstdint>
#include <functional>
#include <memory>

#include "canopen/clock.h"

namespace simulator {

/// A timer with one action. Safe to stop, to start anew and to destroy at any moment: an expiry that is already on its
/// way through the loop is then forgotten.
class Alarm {
 public:
  Alarm(const boost::asio::any_io_executor& executor, std::function<void()> action);

  /// The action runs once, `after` from now. Replaces whatever was started before.
  void start(canopen::Duration after);
  /// The action runs every `period` (more than zero), counted from now without drift.
  void repeat(canopen::Duration period);
  void stop() noexcept;
  [[nodiscard]] bool running() const noexcept { return running_; }

 private:
  void wait_until(canopen::TimePoint at);
  void expire(canopen::TimePoint at);

  canopen::Timer timer_;
  std::function<void()> action_;
  canopen::Duration period_{};
  bool running_ = false;
  /// Counts the starts and stops. Waiting handlers look at it weakly, hence shared.
  std::shared_ptr<std::uint64_t> generation_ = std::make_shared<std::uint64_t>(0);
};

}  // namespace simulator
