#include "canopen/bus.h"

#include <utility>

#include "canopen/bus_core.h"

namespace canopen {

Bus::Bus(boost::asio::any_io_executor executor, std::unique_ptr<Link> link, BusSettings settings)
    : core_(std::make_unique<Core>(std::move(executor), std::move(link), settings)) {}

Bus::~Bus() = default;

void Bus::start() {
  core_->start();
}

boost::asio::awaitable<void> Bus::stop() {
  return core_->stop();
}

Subscription Bus::subscribe(std::uint32_t cob_id, FrameHandler handler) {
  return core_->dispatch().subscribe(cob_id, std::move(handler));
}

Subscription Bus::subscribe_state(StateHandler handler) {
  HandlerList<const BusState&>& handlers = core_->state_handlers();
  const std::uint64_t id = handlers.add(std::move(handler));
  return Subscription([&handlers, id] { handlers.remove(id); });
}

Subscription Bus::subscribe_losses(LossHandler handler) {
  HandlerList<std::uint32_t>& handlers = core_->loss_handlers();
  const std::uint64_t id = handlers.add(std::move(handler));
  return Subscription([&handlers, id] { handlers.remove(id); });
}

bool Bus::send(const Frame& frame) {
  return core_->send(frame, &TransmitQueue::push);
}

bool Bus::repeat(const Frame& frame) {
  return core_->send(frame, &TransmitQueue::push_repetition);
}

boost::asio::awaitable<Result<void>> Bus::send_command(Frame frame, TimePoint deadline) {
  return core_->send_command(frame, deadline);
}

void Bus::withdraw(std::uint32_t cob_id) {
  core_->withdraw(cob_id);
}

TimePoint Bus::heard_until() const {
  return core_->heard_until();
}

const BusState& Bus::state() const noexcept {
  return core_->state();
}

const BusStatistics& Bus::statistics() const noexcept {
  return core_->statistics();
}

const BusSettings& Bus::settings() const noexcept {
  return core_->settings();
}

}  // namespace canopen
