#include "canopen/bus/dispatch.h"

#include <stdexcept>

#include "canopen/hex.h"

namespace canopen {

Subscription Dispatch::subscribe(std::uint32_t cob_id, Handler handler) {
  if (cob_id > kMaxCobId) {
    throw std::invalid_argument("COB-ID 0x" + hex(cob_id, 3) + " is out of range 0x000..0x7FF");
  }
  HandlerList<const Received&>& slot = slots_[cob_id];
  const std::uint64_t id = slot.add(std::move(handler));
  return Subscription([&slot, id] { slot.remove(id); });
}

void Dispatch::deliver(const Received& received) {
  const Frame& frame = received.frame;
  if (frame.error || frame.remote || frame.extended || frame.id > kMaxCobId) {
    return;
  }
  slots_[frame.id].call(received);
}

}  // namespace canopen
