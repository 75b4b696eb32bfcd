#pragma once

#include <cstdint>

#include "canopen/node/node_settings.h"
#include "canopen/node/setup_session.h"
#include "canopen/object.h"

namespace canopen {

// Sub-indexes of a PDO's communication object (CiA 301 §7.5.2.33, §7.5.2.35).
inline constexpr std::uint8_t kPdoInhibitTime = 3;
inline constexpr std::uint8_t kPdoEventTimer = 5;

/// Of a TPDO another time will do, for some nodes round or clamp: an event timer from half to one and a half of the
/// wanted one, so that what is fresh for three periods outlives a missing frame; an inhibit time of at least half, up
/// to the period, or on change up to twice the wanted one or 100 ms. Any other item stays as it is.
void allow_rounding(SetupItem& item, const PdoSettings& tpdo);

}  // namespace canopen
