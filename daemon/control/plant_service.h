#pragma once

#include "bridges/process/plant.h"
#include "daemon/control/record_answer.h"
#include "daemon/control/service.h"
#include "daemon/surveys.h"

namespace gateway::control {

/// Carries out requests on the drives, as the writer `local` with the client's user. `plant` outlives it, and answers
/// everything at its stop().
[[nodiscard]] Service plant_service(process::Plant& plant, Surveys surveys = {}, RecordRequest record = {});

}  // namespace gateway::control
