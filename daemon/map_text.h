#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "config/model.h"

// What all formats of `map` say alike of a signal.

namespace gateway {

/// `canopen/line3`: the topic in front of everything that this gateway publishes.
[[nodiscard]] std::string base_topic(const config::Model& model);
/// Where a signal's value is published; nothing for one that cannot be read, or where single topics are off.
[[nodiscard]] std::optional<std::string> value_topic(const config::Model& model, const config::Drive& drive,
                                                     const config::Signal& signal);
/// Where its commands are taken; nothing for one that cannot be written.
[[nodiscard]] std::optional<std::string> set_topic(const config::Model& model, const config::Drive& drive,
                                                   const config::Signal& signal);

/// As the drive's own unit has it. Nothing for a signal, or a whole drive, that is not on Modbus.
[[nodiscard]] std::optional<config::ModbusPlace> modbus_place(const config::Drive& drive, const config::Signal& signal);

/// The signal's address on the flat unit; nothing where it is not there.
[[nodiscard]] std::optional<std::uint16_t> flat_address(const config::Model& model, const config::Drive& drive,
                                                        const config::Signal& signal);

/// A share of a bus in percent, with one decimal: 0.27345 gives 27.3.
[[nodiscard]] double percent(double share) noexcept;

}  // namespace gateway
