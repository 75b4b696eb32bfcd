#include "canopen/bus/socketcan/interface_state.h"

namespace canopen::socketcan {

BusState state_of(const Interface& interface, const BusState& before) noexcept {
  if (!interface.administratively_up) {
    return BusState{};
  }
  if (interface.condition) {
    BusState state = before;
    state.condition = *interface.condition;
    if (interface.counters) {
      state.transmit_errors = interface.counters->transmit;
      state.receive_errors = interface.counters->receive;
    }
    return state.condition == BusCondition::down ? BusState{} : state;
  }
  if (!interface.carrier) {
    // The driver tells no state: an error frame may have told of a bus-off, else the other end is missing.
    return before.condition == BusCondition::bus_off ? before : BusState{};
  }
  return before.condition == BusCondition::down ? BusState{BusCondition::error_active, 0, 0} : before;
}

}  // namespace canopen::socketcan
