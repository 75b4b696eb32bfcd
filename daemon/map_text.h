#pragma once

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

/// Nothing for a signal, or a whole drive, that is not on Modbus.
[[nodiscard]] std::optional<config::ModbusPlace> modbus_place(const config::Drive& drive, const config::Signal& signal);

/// A share of a bus in percent, with one decimal: 0.27345 gives 27.3.
[[nodiscard]] double percent(double share) noexcept;

}  // namespace gateway
