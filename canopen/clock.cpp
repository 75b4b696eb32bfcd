#include "canopen/clock.h"

namespace canopen {
namespace {

struct StoppedTime {
  unsigned holders = 0;  ///< So many ManualTime live.
  TimePoint monotonic;
  WallTime wall;
  std::uint64_t readings = 0;
};

// Written by tests only; the daemon only ever reads `holders == 0`.
StoppedTime stopped;

}  // namespace

Clock::time_point Clock::now() noexcept {
  if (stopped.holders != 0) {
    ++stopped.readings;
    return stopped.monotonic;
  }
  return time_point(std::chrono::steady_clock::now().time_since_epoch());
}

WallTime wall_now() noexcept {
  if (stopped.holders != 0) {
    ++stopped.readings;
    return stopped.wall;
  }
  return std::chrono::time_point_cast<std::chrono::nanoseconds>(std::chrono::system_clock::now());
}

TimePoint or_soon(TimePoint at, TimePoint now) noexcept {
  return at > now ? at : now + std::chrono::milliseconds(1);
}

ManualTime::ManualTime() noexcept {
  using namespace std::chrono;
  stopped.monotonic = TimePoint(hours(1));
  stopped.wall = sys_days(year(2026) / January / 2) + hours(3) + minutes(4) + seconds(5);
  stopped.readings = 0;
  ++stopped.holders;
}

ManualTime::~ManualTime() {
  --stopped.holders;
}

void ManualTime::advance(Duration by) noexcept {
  stopped.monotonic += by;
  stopped.wall += by;
}

bool ManualTime::active() noexcept {
  return stopped.holders != 0;
}

std::uint64_t ManualTime::readings() noexcept {
  return stopped.readings;
}

Duration WaitTraits::to_wait_duration(const Duration& duration) noexcept {
  return stopped.holders != 0 ? Duration::zero() : duration;
}

Duration WaitTraits::to_wait_duration(const TimePoint& expiry) noexcept {
  return to_wait_duration(expiry - Clock::now());
}

}  // namespace canopen
