#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "canopen/object.h"
#include "config/model.h"

namespace journal {

/// A quoted and escaped JSON string of at most 1000 bytes of `text`.
void append_text(std::string& out, std::string_view text);
/// Engineering units with the decimals of the scale, in digits: `49.97`; `null` for a REAL that is no number.
void append_value(std::string& out, const config::Signal& signal, canopen::Raw raw);
/// A number as somebody gave it; `null` for nothing, and for what is no number.
void append_given(std::string& out, std::optional<double> number);
/// Unscaled: `true`, `-3`, `0.5`, `null`.
void append_raw(std::string& out, canopen::DataType type, canopen::Raw raw);

}  // namespace journal
