#include "canopen/node/node_guarding.h"

#include <utility>

#include "canopen/bus/bus.h"
#include "canopen/node/heartbeat_consumer.h"

namespace canopen {
namespace {

Frame guarding_request(std::uint8_t node) noexcept {
  Frame request;
  request.id = kErrorControlBase + node;
  request.size = 1;
  request.remote = true;
  return request;
}

}  // namespace

NodeGuarding::NodeGuarding(const boost::asio::any_io_executor& executor, Bus& bus, std::uint8_t node, Duration period)
    : bus_(bus),
      request_(guarding_request(node)),
      producer_(executor, request_, period, [this](const Frame& request) { send(request); }) {}

void NodeGuarding::ask() {
  send(request_);
}

void NodeGuarding::start() {
  if (!std::exchange(running_, true)) {
    good_in_a_row_ = 0;
    answered_ = false;
    producer_.start();
  }
}

void NodeGuarding::stop() {
  running_ = false;
  producer_.stop();
  ticket_.reset();
}

GuardAnswer NodeGuarding::take(bool toggle) noexcept {
  answered_ = true;
  if (expected_.value_or(toggle) != toggle) {
    good_in_a_row_ = 0;
    return std::exchange(wrong_, true) ? GuardAnswer::wrong_toggle_again : GuardAnswer::wrong_toggle;
  }
  expected_ = !toggle;
  ++good_in_a_row_;
  wrong_ = false;
  return GuardAnswer::good;
}

/// One that still waits is withdrawn: requests never pile up.
void NodeGuarding::send(const Frame& request) {
  ticket_ = bus_.send(TransmitClass::control, request, Clock::now() + TransmitQueue::kLifeTime);
}

}  // namespace canopen
