#pragma once

#include <string_view>
#include <variant>

#include "bridges/mqtt/command.h"
#include "bridges/mqtt/sdo_request.h"
#include "bridges/mqtt/topics.h"
#include "bridges/process/command.h"
#include "canopen/error.h"
#include "config/model.h"

namespace mqtt {

/// The first stop value to all drives.
struct StopAll {};

/// What a command asks for, as far as topic, payload and configuration say.
using Asked = std::variant<StopAll, Fields, canopen::NmtCommand, SdoRequest>;

/// A command comes by this topic.
[[nodiscard]] bool carries_command(const Route& route) noexcept;

/// The payload of a command of this topic, taken apart.
[[nodiscard]] Parsed parse_command(const Route& route, std::string_view payload);

/// `drive` null: there is none of that name. `unknown`, `type`, `read_only`, and what command.h says; a mistake in one
/// of several fields stands in Fields.
[[nodiscard]] canopen::Result<Asked> asked_of(const config::Drive* drive, const Route& route, const Parsed& parsed);

/// Asks for a value and changes nothing, whatever else is wrong with it.
[[nodiscard]] bool asks_to_read(const Route& route, const Parsed& parsed);

/// It stops the drive, by whatever way, or all.
[[nodiscard]] bool stops(const config::Drive& drive, const Asked& asked);

}  // namespace mqtt
