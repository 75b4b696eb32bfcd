#pragma once

#include <span>

#include "bridges/process/command.h"
#include "config/model.h"

namespace process {

/// A command with these fields stops that drive: nothing may keep it waiting. None of them changes bits alone (Mask).
[[nodiscard]] bool is_stop(const config::Drive& model, std::span<const FieldWrite> fields);

}  // namespace process
