#pragma once

#include <string_view>

#include "canopen/error.h"

namespace text {

/// A finite decimal number, all of the text. `type` for other text, NaN and infinity; `range` beyond what a double
/// holds.
[[nodiscard]] canopen::Result<double> number_of(std::string_view text);

}  // namespace text
