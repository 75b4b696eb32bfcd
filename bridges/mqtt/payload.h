#pragma once

#include <string>

#include "bridges/mqtt/pace.h"
#include "bridges/process/control.h"
#include "bridges/process/drive.h"
#include "canopen/clock.h"

namespace mqtt {

/// What `B/<drive>/state` says: every readable signal, null where it is not fresh.
[[nodiscard]] std::string state_json(const process::Drive& drive, const Pace& pace, canopen::TimePoint now);

/// What `B/<drive>/<signal>` says; empty where the value is not fresh.
[[nodiscard]] std::string signal_text(const process::Drive& drive, process::SignalId signal, Shape shape,
                                      canopen::TimePoint now);

/// What `B/<drive>/control` says: who holds the lease, and whether the command timeout has acted. Of one form always:
/// where nobody holds it, `holder` and `since` are null.
[[nodiscard]] std::string control_json(const process::ControlState& control);

[[nodiscard]] inline std::string online_text(bool online) {
  return online ? "online" : "offline";
}

}  // namespace mqtt
