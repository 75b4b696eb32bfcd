#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "bridges/process/plant.h"
#include "canopen/clock.h"
#include "daemon/surveys.h"

namespace gateway::control {

/// What `status` tells, as one JSON object: the gateway, its buses, its drives with their values, what was commanded,
/// and the alarms that are active. Numbers in engineering units, times in seconds, loads in percent.
[[nodiscard]] std::string status_json(const process::Plant& plant, canopen::TimePoint started, canopen::TimePoint now,
                                      const Surveys& surveys = {});

/// The beginning of it, up to the list of drives; behind these it is closed by `]}`.
[[nodiscard]] std::string status_head(const process::Plant& plant, canopen::TimePoint started, canopen::TimePoint now,
                                      const Surveys& surveys);

/// Whether that is told which changes by time alone.
enum class Ages : std::uint8_t { shown, hidden };

/// The part of it that is about one drive.
void append_drive_status(std::string& out, const process::Plant& plant, std::size_t index, canopen::TimePoint now,
                         Ages ages = Ages::shown);

}  // namespace gateway::control
