#include "canopen/bus/cyclic_producer.h"

#include <array>

#include "canopen/cob_id.h"
#include "canopen/nmt.h"

namespace canopen {

Frame heartbeat_frame(std::uint8_t node_id) noexcept {
  const std::array state{static_cast<std::uint8_t>(NmtState::operational)};
  return make_frame(kErrorControlBase + node_id, state);
}

Frame sync_frame() noexcept {
  return make_frame(kSyncCobId, {});
}

CyclicProducer::CyclicProducer(const boost::asio::any_io_executor& executor, Frame frame, Duration period,
                               std::function<void(const Frame&)> send)
    : frame_(frame), period_(period), send_(std::move(send)), wake_up_(executor, [this] { produce(); }) {}

void CyclicProducer::start() {
  next_ = Clock::now();
  produce();
}

void CyclicProducer::stop() {
  wake_up_.cancel();
}

void CyclicProducer::produce() {
  const TimePoint now = Clock::now();
  next_ += period_;
  if (next_ <= now) {
    next_ = now + period_;
  }
  wake_up_.arm(next_);
  send_(frame_);
}

}  // namespace canopen
