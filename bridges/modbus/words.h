#pragma once

#include <cstdint>
#include <span>
#include <variant>

#include "bridges/process/command.h"
#include "canopen/object.h"
#include "config/model.h"

// Values as registers: 16 bits each, the words of a wider value in the configured order.

namespace modbus {

/// The low 16 bits go into the last (big) or the first (little) of `out`.
void put_words(std::uint64_t value, config::WordOrder order, std::span<std::uint16_t> out) noexcept;

/// What the registers of `signal` show for a raw value: `signal.modbus.count` words, extended by sign; with `as_float`
/// the engineering value as IEEE 754 single. `out` holds that many.
void put_value(const config::Signal& signal, canopen::Raw raw, config::WordOrder order,
               std::span<std::uint16_t> out) noexcept;

/// What a client wrote: `bytes` are two per register, high byte first. A raw value, or with `as_float` a number in
/// engineering units. One that the signal's type cannot hold comes as it is: the arbiter refuses it as out of range,
/// and carries out a stop that it stands beside.
[[nodiscard]] process::GivenValue value_of(const config::Signal& signal, std::span<const std::uint8_t> bytes,
                                           config::WordOrder order) noexcept;

}  // namespace modbus
