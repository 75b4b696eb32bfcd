#pragma once

#include "canopen/survey/suspicion.h"

// What is said of each suspicion: what was seen, and what to look at first. None of it is certain, and none says so.

namespace canopen {

[[nodiscard]] Suspicion suspect_doubled_id(const Signs& signs);
[[nodiscard]] Suspicion suspect_alone(const Signs& signs);
[[nodiscard]] Suspicion suspect_bit_rate(const Signs& signs);
[[nodiscard]] Suspicion suspect_wiring(const Signs& signs);
[[nodiscard]] Suspicion suspect_overload(const Signs& signs);

}  // namespace canopen
