#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "bridges/trace/entry.h"
#include "canopen/object.h"
#include "config/model.h"

namespace trace {

/// The signal of this object; null: none has it. Where one is read and another written, `way` decides.
[[nodiscard]] const config::Signal* find_signal(const config::Drive& drive, canopen::ObjectAddress object, PdoWay way);

/// A value in engineering units with its unit, `49.97 Hz`, `forward (1)`; a word with what its bits say, `0x0637
/// (running, ready)`.
[[nodiscard]] std::string signal_value(const config::Drive& drive, const config::Signal& signal, canopen::Raw raw);

/// `0x2021:02 output_frequency`, `0x1017:00 producer heartbeat time`, or the bare address. `drive`: null for a
/// stranger.
[[nodiscard]] std::string object_name(const config::Drive* drive, canopen::ObjectAddress object, PdoWay way);

/// The value of an object, whole; `bytes`: how long it is, which may be more than was kept.
[[nodiscard]] std::string object_value(const config::Drive* drive, canopen::ObjectAddress object, PdoWay way,
                                       std::span<const std::uint8_t> kept, std::size_t bytes);

/// `01 0A FF`
[[nodiscard]] std::string bytes_text(std::span<const std::uint8_t> bytes);

}  // namespace trace
