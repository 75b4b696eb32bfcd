#include "canopen/bus/socketcan/error_frame.h"

#include <linux/can/error.h>

namespace canopen::socketcan {
namespace {

constexpr std::size_t kControllerStatus = 1;
constexpr std::size_t kTransmitErrors = 6;
constexpr std::size_t kReceiveErrors = 7;

BusCondition condition_after(BusCondition before, const Frame& frame) noexcept {
  if ((frame.id & CAN_ERR_BUSOFF) != 0) {
    return BusCondition::bus_off;
  }
  if ((frame.id & CAN_ERR_CRTL) != 0) {
    const unsigned status = frame.data[kControllerStatus];
    if ((status & (CAN_ERR_CRTL_RX_PASSIVE | CAN_ERR_CRTL_TX_PASSIVE)) != 0) {
      return BusCondition::passive;
    }
    if ((status & (CAN_ERR_CRTL_RX_WARNING | CAN_ERR_CRTL_TX_WARNING)) != 0) {
      return BusCondition::warning;
    }
    if ((status & CAN_ERR_CRTL_ACTIVE) != 0) {
      return BusCondition::error_active;
    }
  }
  return (frame.id & CAN_ERR_RESTARTED) != 0 ? BusCondition::error_active : before;
}

}  // namespace

BusState after_error_frame(const BusState& before, const Frame& frame) noexcept {
  BusState after = before;
  after.condition = condition_after(before.condition, frame);
  // Not every driver fills the counters; one that does not leaves them 0, which is also what a restart means.
  const bool counted = frame.data[kTransmitErrors] != 0 || frame.data[kReceiveErrors] != 0;
  if (counted || after.condition != before.condition) {
    after.transmit_errors = frame.data[kTransmitErrors];
    after.receive_errors = frame.data[kReceiveErrors];
  }
  return after;
}

bool tells_more_than_an_error(const Frame& frame) noexcept {
  return (frame.id & (CAN_ERR_CRTL | CAN_ERR_BUSOFF | CAN_ERR_RESTARTED | CAN_ERR_ACK)) != 0;
}

bool tells_no_acknowledge(const Frame& frame) noexcept {
  return (frame.id & CAN_ERR_ACK) != 0;
}

bool tells_overrun(const Frame& frame) noexcept {
  return (frame.id & CAN_ERR_CRTL) != 0 && (frame.data[kControllerStatus] & CAN_ERR_CRTL_RX_OVERFLOW) != 0;
}

}  // namespace canopen::socketcan
