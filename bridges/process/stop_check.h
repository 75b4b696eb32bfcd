#pragma once

#include <span>

#include "bridges/process/command.h"
#include "config/model.h"

namespace process {

/// That word of `control_command`, which `control` is, only ever stops the motor.
[[nodiscard]] bool is_stop(const config::Drive& model, const config::Signal& control, canopen::Raw word) noexcept;
/// A command with these fields stops that drive: nothing may keep it waiting. None of them changes bits alone (Mask).
[[nodiscard]] bool is_stop(const config::Drive& model, std::span<const FieldWrite> fields);

}  // namespace process
