#include "simulator/veichi_tables.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "simulator/pdo_settings.h"

namespace simulator {
namespace {

/// Manual table 3.8: 0 at every SYNC, 1..240 at every n-th, 252 and 253 not supported, 254 on change, 255 on change or
/// event time.
std::optional<Triggers> veichi_triggers(std::uint8_t /*number*/, std::uint8_t type, std::uint16_t event) {
  Triggers result;
  if (type <= 240) {
    result.every_sync = std::max<std::uint8_t>(type, 1);
  } else if (type >= 254) {
    result.change = true;
    result.timer = type == 255 && event != 0;
  } else {
    return std::nullopt;
  }
  return result;
}

/// Manual table 3.9. "Timing transfer 100 ms": on change or after 100 ms, and not more often than every 100 ms.
PdoDefaults timed(std::vector<std::uint32_t> map) {
  return {true, 255, 1000, 100, std::move(map)};
}

}  // namespace

Traits veichi_traits(bool pdo_objects) {
  Traits traits;
  traits.sync_objects = false;
  traits.emergency_objects = false;
  traits.short_sdo_requests = true;
  traits.segmented_sdo = false;
  // Manual table 3.7.
  traits.known_aborts = {Abort::unknown_command, Abort::read_only,        Abort::no_object,
                         Abort::not_mappable,    Abort::mapping_too_long, Abort::wrong_length,
                         Abort::no_sub_index,    Abort::invalid_value,    Abort::general};
  PdoRules& pdo = traits.pdo;
  pdo.transmit = {timed({map_value(kVeichiControlBlock, 3, 16), map_value(kVeichiMonitoring, 3, 16),
                         map_value(kVeichiMonitoring, 2, 16), map_value(kVeichiMonitoring, 6, 16)}),
                  timed({map_value(kVeichiMonitoring, 0x0B, 16), map_value(kVeichiMonitoring, 4, 16),
                         map_value(kVeichiControlBlock, 4, 16)}),
                  timed({map_value(kVeichiMonitoring, 8, 16), map_value(kVeichiMonitoring, 0x0C, 16),
                         map_value(kVeichiMonitoring, 5, 16), map_value(kVeichiMonitoring, 0x0D, 16)}),
                  timed({})};
  pdo.receive = {{true,
                  255,
                  0,
                  0,
                  {map_value(kVeichiControlBlock, 2, 16), map_value(kVeichiControlBlock, 1, 16),
                   map_value(kVeichiControlBlock, 6, 16)}},
                 {},
                 {},
                 {}};
  pdo.objects_present = pdo_objects;
  pdo.rpdo_waits_for_sync = false;  // "Effective immediately" for every type.
  pdo.length_errors = false;
  // "The control command and run status are mandatory mapping variables."
  pdo.mandatory_transmit = map_value(kVeichiControlBlock, 3, 16);
  pdo.mandatory_receive = map_value(kVeichiControlBlock, 2, 16);
  pdo.triggers = veichi_triggers;
  return traits;
}

/// F00..F31 at 0x2000..0x201F; with power-down save F00..F15 at 0x20F0.. and F16..F31 at 0x20A0..; sub-index is the
/// number plus one.
std::optional<VeichiParameter> veichi_parameter(Address address) {
  if (address.sub == 0) {
    return std::nullopt;
  }
  const auto place = [&](unsigned group, bool stored) {
    return VeichiParameter{static_cast<std::uint16_t>((group << 8U) | (address.sub - 1U)), stored};
  };
  if (address.index >= 0x2000 && address.index <= 0x201F) {
    return place(address.index - 0x2000U, false);
  }
  if (address.index >= 0x20F0 && address.index <= 0x20FF) {
    return place(address.index - 0x20F0U, true);
  }
  if (address.index >= 0x20A0 && address.index <= 0x20AF) {
    return place(address.index - 0x20A0U + 16U, true);
  }
  return std::nullopt;
}

}  // namespace simulator
