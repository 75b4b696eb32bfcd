#include "bridges/text/number_text.h"

#include <charconv>
#include <cmath>
#include <string>

namespace text {

using canopen::Error;
using canopen::ErrorKind;

canopen::Result<double> number_of(std::string_view text) {
  double value = 0.0;
  const auto end = std::from_chars(text.data(), text.data() + text.size(), value);
  if (end.ptr == text.data() + text.size() && end.ec == std::errc::result_out_of_range) {
    return Error{.kind = ErrorKind::range, .detail = "the number has too large an exponent"};
  }
  if (text.empty() || end.ec != std::errc{} || end.ptr != text.data() + text.size() || !std::isfinite(value)) {
    return Error{.kind = ErrorKind::type, .detail = "\"" + std::string(text.substr(0, 64)) + "\" is not a number"};
  }
  return value;
}

}  // namespace text
