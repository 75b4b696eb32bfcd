#pragma once

#include <string>
#include <variant>

#include "canopen/error.h"
#include "canopen/object.h"
#include "config/model.h"

namespace config {

/// The raw value to send for a commanded one (raw as from a register, or in engineering units). Refused, never clamped:
/// outside of min..max, else of the type, judged before rounding. A value between two raw steps becomes the nearest.
/// NaN and infinity are no values (`type`). The error's detail is for people: `out of range 0..50`.
[[nodiscard]] canopen::Result<canopen::Raw> check_value(const Signal& signal,
                                                        const std::variant<canopen::Raw, double>& value);

/// `0..50`: what a value of this signal may be, in engineering units.
[[nodiscard]] std::string range_text(const Signal& signal);

}  // namespace config
