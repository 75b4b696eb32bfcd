#pragma once

#include "config/drive_notes.h"
#include "daemon/compare/drive_view.h"

// The groups of what is compared, in the order in which they are read. Each says in words what to do.

namespace gateway::compare {

/// 0x1000 and 0x1018, as far as the configuration says what they are.
void compare_identity(DriveView& view);
/// 0x1017, who supervises the gateway (0x1016), guarding (0x100C, 0x100D).
void compare_error_control(DriveView& view);
/// Communication and mapping of every PDO that the configuration uses.
void compare_pdos(DriveView& view);
/// What `setup` writes at every boot.
void compare_setup(DriveView& view);
/// What the profile knows beside that: where commands come from, limits, units.
void compare_live_checks(DriveView& view, const config::DriveNotes& notes);

}  // namespace gateway::compare
