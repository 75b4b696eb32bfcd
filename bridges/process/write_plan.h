#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "bridges/process/image.h"
#include "canopen/object.h"
#include "config/model.h"

namespace process {

class Commanded;

/// A checked value on its way to the drive.
struct Field {
  SignalId signal = 0;
  canopen::Raw raw = 0;
};

/// What goes out next: several fields in one RPDO, or one by SDO.
struct WriteStep {
  std::uint16_t rpdo = 0;  ///< 0: by SDO.
  std::vector<Field> fields;
};

/// Each signal once, the last value given; set-points in their order, `control_command` last.
[[nodiscard]] std::vector<Field> in_writing_order(const Commanded& commanded, std::vector<Field> fields);

/// The next step of writing `remaining` (not empty, in writing order): an RPDO where these fields complete it, else the
/// first by SDO; what writes the control command comes last.
[[nodiscard]] WriteStep next_step(const Commanded& commanded, std::span<const Field> remaining);

/// The first of `remaining` that its RPDO alone can carry, and does not: these fields do not complete it.
[[nodiscard]] std::optional<SignalId> first_unsendable(const config::Drive& model, const Commanded& commanded,
                                                       std::span<const Field> remaining);

/// Those of `fields` that RPDO `rpdo` maps.
[[nodiscard]] std::vector<Field> fields_of(const Commanded& commanded, std::uint16_t rpdo,
                                           std::span<const Field> fields);

/// What completes an RPDO, for people: `write control_command, frequency_command and torque_command together`.
[[nodiscard]] std::string completion_text(const config::Drive& model, std::uint16_t rpdo);

}  // namespace process
