#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "bridges/process/image.h"
#include "bridges/text/json_text.h"
#include "canopen/object.h"
#include "config/model.h"

namespace mqtt {

/// The one JSON type a signal has, always.
enum class Shape : std::uint8_t { boolean, number, name };
[[nodiscard]] Shape shape_of(const config::Drive& drive, process::SignalId signal);

/// The value as its own topic shows it: `true`, `49.97` with the decimals of the scale, `stopped`, `unknown(17)`.
/// False (and nothing appended) for a REAL that is no number.
[[nodiscard]] bool append_value(std::string& out, const config::Signal& signal, Shape shape, canopen::Raw raw);

/// The same as a member of a JSON object, a name as a string; null where there is no value.
void append_member(text::ObjectText& object, const config::Signal& signal, Shape shape,
                   std::optional<canopen::Raw> raw);

/// The raw integer in its type's sign, all digits.
[[nodiscard]] std::string integer_text(canopen::DataType type, canopen::Raw raw);

}  // namespace mqtt
