#pragma once

#include <vector>

#include "bridges/mqtt/home_assistant/entity.h"
#include "bridges/mqtt/topics.h"
#include "config/model.h"

namespace mqtt::home_assistant {

/// What is read: each readable signal, and the NMT state.
void append_readings(std::vector<Entity>& entities, const config::Drive& drive, const DriveTopics& topics,
                     const config::Mqtt& settings);

}  // namespace mqtt::home_assistant
