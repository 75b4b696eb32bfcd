#include "bridges/mqtt/homecoming.h"

#include <algorithm>

namespace mqtt {

Homecoming::Step Homecoming::due(TimePoint now) const noexcept {
  if (looked_ && now - *looked_ < interval()) {
    return Step::none;
  }
  // A trial is good for a while: the password may have been changed since.
  const bool wants_trial = !taken_ || now - *taken_ >= shortest_;
  return since_ && now - *since_ >= reachable_ && wants_trial ? Step::try_it : Step::look;
}

void Homecoming::looked(bool reached, TimePoint now) noexcept {
  constexpr int kMissed = 3;
  // Where nobody looked meanwhile, as on a machine that slept, nobody knows.
  const bool gap = looked_ && now - *looked_ > kMissed * interval();
  looked_ = now;
  if (!reached) {
    since_.reset();
    taken_.reset();
  } else if (!since_ || gap) {
    since_ = now;
    taken_.reset();
  }
}

void Homecoming::tried(bool taken, TimePoint now) noexcept {
  looked(taken, now);
  if (taken) {
    taken_ = now;
  } else {
    fail(now);
  }
}

void Homecoming::ended(Milliseconds stood, bool stays, TimePoint now) noexcept {
  if (stood >= shortest_) {
    reachable_ = shortest_;
    returning_ = false;
  }
  arriving_ = false;
  looked_ = now;
  since_.reset();
  taken_.reset();
  if (returning_ && !stays) {
    fail(now);
  }
}

Homecoming::Milliseconds Homecoming::interval() const noexcept {
  return std::max(interval_, std::min<Milliseconds>(interval_ * (reachable_ / shortest_), kRarest));
}

void Homecoming::fail(TimePoint now) noexcept {
  returning_ = false;
  looked_ = now;
  reachable_ = std::max(shortest_, std::min<Milliseconds>(2 * reachable_, kLongest));
}

}  // namespace mqtt
