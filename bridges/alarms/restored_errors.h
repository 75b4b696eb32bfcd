#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "bridges/alarms/alarm.h"
#include "config/model.h"

namespace alarms {

/// The errors of an emergency alarm as the broker kept it, oldest first. There all are listed with one severity, that
/// of the newest fault, or of a warning where there is no fault: what is newer than that fault is a warning, and of
/// what is older the fault texts may tell.
[[nodiscard]] std::vector<AlarmError> restored_errors(const config::Drive& model, const Alarm& before);

/// The drive's own number of such an error, where its emergency carried one and the broker kept it.
[[nodiscard]] std::optional<std::uint64_t> drive_code_of(const config::Drive& model, const AlarmError& error);

}  // namespace alarms
