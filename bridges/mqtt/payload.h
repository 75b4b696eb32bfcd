#pragma once

#include <optional>
#include <span>
#include <string>

#include "bridges/mqtt/pace.h"
#include "bridges/process/control.h"
#include "bridges/process/drive.h"
#include "canopen/clock.h"

namespace mqtt {

/// When the newest value was received, by the monotonic clock: the time of day may have been set back since an older
/// one.
[[nodiscard]] std::optional<canopen::WallTime> newest_value(std::span<const process::SourceState> sources);

/// What `B/<drive>/state` says: every readable signal, null where it is not fresh. Without a time what an orderly end
/// leaves there: offline, and null for everything.
[[nodiscard]] std::string state_json(const process::Drive& drive, const Pace& pace,
                                     std::optional<canopen::TimePoint> now);

/// What `B/<drive>/<signal>` says; nothing where the value is not fresh, or no number.
[[nodiscard]] std::optional<std::string> signal_text(const process::Drive& drive, process::SignalId signal, Shape shape,
                                                     canopen::TimePoint now);

/// What `B/<drive>/control` says: who holds the lease, and whether the command timeout has acted. Of one form always:
/// where nobody holds it, `holder` and `since` are null.
[[nodiscard]] std::string control_json(const process::ControlState& control);

[[nodiscard]] inline std::string online_text(bool online) {
  return online ? "online" : "offline";
}

}  // namespace mqtt
