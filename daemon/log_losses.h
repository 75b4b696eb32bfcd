#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <cstddef>
#include <functional>

#include "canopen/clock.h"

namespace gateway {

/// Tells that the log loses messages while it does, and not only at the end, which after a crash never comes: at once,
/// then at most each minute.
class LogLosses {
 public:
  /// `dropped`: messages since the start. `tell`: how many were lost that were not told yet, and all.
  LogLosses(const boost::asio::any_io_executor& executor, std::function<std::size_t()> dropped,
            std::function<void(std::size_t lost, std::size_t all)> tell);

 private:
  void watch();

  std::function<std::size_t()> dropped_;
  std::function<void(std::size_t, std::size_t)> tell_;
  canopen::Timer timer_;
  std::size_t told_ = 0;
};

}  // namespace gateway
