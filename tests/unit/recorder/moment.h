#pragma once

#include <chrono>

#include "canopen/clock.h"

namespace recorder {

/// So long after the first hour of the clock.
inline canopen::TimePoint moment(canopen::Duration time) {
  return canopen::TimePoint(std::chrono::hours(1) + time);
}

}  // namespace recorder
