#pragma once

#include "canopen/clock.h"

namespace canopen {

/// How long the node's answers to one stop are waited for, beside its deadline: those to all that is written, written
/// again and read for it. Kept by who sends the stop until that is over, and shortened by SdoClient::hurry_stop().
struct StopLimit {
  TimePoint until = kNever;
};

/// Of a stop that nothing newer waits for.
inline constexpr StopLimit kNoStopLimit;

}  // namespace canopen
