#pragma once

#include <cstddef>
#include <functional>
#include <string>

#include "bridges/process/plant.h"
#include "bridges/recorder/recorder.h"
#include "canopen/error.h"
#include "daemon/control/service.h"

namespace gateway::control {

/// See recorder::Recorder::request(). Empty: nothing is recorded.
using RecordRequest = std::function<canopen::Result<recorder::Recorder::Requested>(
    std::size_t bus, const std::string& drive, const std::string& user)>;

/// What it answers where there is no recorder.
[[nodiscard]] canopen::Error nothing_recorded();

/// `{"id":7,"ok":true,"record":"20260102T030405.678Z-pump1-request.log","under_way":false,"remaining_ms":5000}`, or a
/// refusal.
[[nodiscard]] std::string record_answer(const Asked& asked, const process::Plant& plant, const RecordRequest& request);

}  // namespace gateway::control
