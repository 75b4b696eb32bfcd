#include "canopen/node/pdo_times.h"

#include <algorithm>

namespace canopen {

void allow_rounding(SetupItem& item, const PdoSettings& tpdo) {
  // A TPDO on change that is held back for so long is no harm, whatever was wanted.
  constexpr Duration kHarmless = std::chrono::milliseconds(100);
  if (item.object.sub == kPdoEventTimer && item.wanted != 0) {
    item.least = (item.wanted + 1) / 2;
    item.most = item.wanted + item.wanted / 2;
  } else if (item.object.sub == kPdoInhibitTime) {
    const Duration wanted = static_cast<Duration::rep>(item.wanted) * tpdo.inhibit_unit;
    const Duration longest = tpdo.period > Duration::zero() ? tpdo.period : std::max<Duration>(2 * wanted, kHarmless);
    item.least = (item.wanted + 1) / 2;
    item.most = static_cast<Raw>(longest / tpdo.inhibit_unit);
  }
}

}  // namespace canopen
