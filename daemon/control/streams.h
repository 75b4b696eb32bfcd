#pragma once

#include "bridges/process/plant.h"
#include "bridges/trace/feed.h"
#include "daemon/control/service.h"
#include "daemon/surveys.h"

namespace gateway::control {

/// For Service::open_stream: `trace` and the watched `status`. Both outlive it.
[[nodiscard]] OpenStream stream_source(const process::Plant& plant, trace::Feed& feed, Surveys surveys = {});

}  // namespace gateway::control
