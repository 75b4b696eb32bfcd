#pragma once

#include <vector>

#include "bridges/mqtt/home_assistant/entity.h"
#include "bridges/mqtt/topics.h"
#include "config/model.h"

namespace mqtt::home_assistant {

/// What people may command: set-points as numbers; values that have names as a choice, those that are momentary as
/// buttons; the first stop of the profile as a button. A word without names is nothing to choose from. What a drive
/// holds is shown where it can be read; else `unknown`, never what was asked for last.
void append_commands(std::vector<Entity>& entities, const config::Drive& drive, const DriveTopics& topics);

}  // namespace mqtt::home_assistant
