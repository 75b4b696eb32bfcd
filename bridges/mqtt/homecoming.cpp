#include "bridges/mqtt/homecoming.h"

namespace mqtt {

void Homecoming::looked(bool reached, TimePoint now) noexcept {
  constexpr int kMissed = 3;
  // Where nobody looked meanwhile, as on a machine that slept, nobody knows.
  const bool gap = looked_ && now - *looked_ > kMissed * interval_;
  looked_ = now;
  if (!reached) {
    since_.reset();
  } else if (!since_ || gap) {
    since_ = now;
  }
}

}  // namespace mqtt
