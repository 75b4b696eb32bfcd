#pragma once

#include <string_view>

#include "bridges/process/command.h"
#include "canopen/error.h"
#include "canopen/object.h"

namespace mqtt {

/// A finite decimal number, all of the text. `type` for other text, NaN and infinity; `range` beyond what a double
/// holds.
[[nodiscard]] canopen::Result<double> number_of(std::string_view text);

/// The same for a value of `type`: a whole number in a 64-bit integer type, which a double would round, is its raw
/// value; `range` where the type cannot hold it.
[[nodiscard]] canopen::Result<process::GivenValue> number_in(canopen::DataType type, std::string_view text);

}  // namespace mqtt
