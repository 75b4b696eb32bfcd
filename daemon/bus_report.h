#pragma once

#include <cstddef>
#include <string>

#include "bridges/process/plant.h"
#include "bridges/text/json_text.h"
#include "daemon/surveys.h"

namespace gateway {

// How sound buses are, as JSON for HTTP and the control socket: loads and margins from 0 to 1, times in seconds.
// docs/BUS_HEALTH.md describes it.

/// The members `suspicion` (a text, or null) and `heartbeat_margin` (of the drive with the least, or null). Without
/// surveys both are null.
void append_bus_summary(text::ObjectText& to, const process::Plant& plant, std::size_t bus, const Surveys& surveys);

/// All that is known of one bus, as one object.
void append_bus_report(std::string& out, const process::Plant& plant, std::size_t bus,
                       const canopen::BusSurvey& survey);

/// Those of all buses, as a list.
[[nodiscard]] std::string bus_reports(const process::Plant& plant, const Surveys& surveys);

}  // namespace gateway
