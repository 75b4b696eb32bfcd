#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <functional>

#include "canopen/clock.h"
#include "canopen/frame.h"
#include "canopen/wake_up.h"

namespace canopen {

/// Our own heartbeat (CiA 301 §7.2.8.3.2.2): the gateway is operational for as long as it runs. No boot-up message goes
/// before it: a drive that supervises us must not take a restart of the gateway for a reset of its master.
[[nodiscard]] Frame heartbeat_frame(std::uint8_t node_id) noexcept;
/// SYNC without a counter (CiA 301 §7.2.5): not every drive accepts one.
[[nodiscard]] Frame sync_frame() noexcept;

/// Produces one frame at a fixed period without drift. After a pause of the process it goes on with the next period;
/// what was missed is not made up for.
class CyclicProducer {
 public:
  CyclicProducer(const boost::asio::any_io_executor& executor, Frame frame, Duration period,
                 std::function<void(const Frame&)> send);

  /// The first frame goes at once; where it runs already, the period starts anew.
  void start();
  void stop();

 private:
  void produce();

  Frame frame_;
  Duration period_;
  std::function<void(const Frame&)> send_;
  TimePoint next_;
  WakeUp wake_up_;
};

}  // namespace canopen
