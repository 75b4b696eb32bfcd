#pragma once

#include <boost/asio/steady_timer.hpp>
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>

#include "canopen/bus/link.h"
#include "tests/bench/site.h"

namespace bench {

/// Frames of somebody on a site's bus, evenly over the time, until it is destroyed.
class BusLoad {
 public:
  /// `frame(n)` is the n-th one.
  BusLoad(SiteInThread& site, unsigned per_second, std::function<canopen::Frame(std::uint64_t)> frame);
  ~BusLoad();
  BusLoad(const BusLoad&) = delete;
  BusLoad& operator=(const BusLoad&) = delete;

  [[nodiscard]] std::uint64_t sent();

 private:
  void step();

  SiteInThread& site_;
  unsigned per_second_;
  std::function<canopen::Frame(std::uint64_t)> frame_;
  boost::asio::steady_timer timer_;
  std::unique_ptr<canopen::Link> link_;
  std::chrono::steady_clock::time_point begin_{};
  std::uint64_t sent_ = 0;
  bool stop_ = false;
};

}  // namespace bench
