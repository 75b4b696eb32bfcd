#pragma once

#include <optional>
#include <string_view>

#include "canopen/error.h"
#include "canopen/object.h"

namespace mqtt {

/// A finite decimal number, all of the text. `type` for other text, NaN and infinity; `range` beyond what a double
/// holds.
[[nodiscard]] canopen::Result<double> number_of(std::string_view text);

/// The exact raw value of a whole number in a 64-bit integer type, which a double would round; nothing where the text
/// has a fraction or an exponent, or the type is none of these. `range` where the type cannot hold it.
[[nodiscard]] std::optional<canopen::Result<canopen::Raw>> exact_integer(canopen::DataType type, std::string_view text);

}  // namespace mqtt
