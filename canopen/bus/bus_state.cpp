#include "canopen/bus/bus_state.h"

namespace canopen {

std::string_view describe(BusCondition condition) noexcept {
  switch (condition) {
    case BusCondition::error_active:
      return "up (error-active)";
    case BusCondition::warning:
      return "error-warning: many errors on the bus";
    case BusCondition::passive:
      return "error-passive: no other node acknowledges, or the wiring disturbs";
    case BusCondition::bus_off:
      return "bus-off: the controller has left the bus";
    case BusCondition::down:
      break;
  }
  return "down: the interface is missing or switched off";
}

}  // namespace canopen
