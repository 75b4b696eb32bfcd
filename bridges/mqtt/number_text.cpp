#include "bridges/mqtt/number_text.h"

#include <charconv>
#include <cmath>
#include <string>

namespace mqtt {
namespace {

using canopen::DataType;
using canopen::Error;
using canopen::ErrorKind;

// A fraction or an exponent makes it no integer.
bool is_integer(std::string_view text) {
  const std::size_t sign = text.starts_with('-') ? 1 : 0;
  return text.size() > sign && text.find_first_not_of("0123456789", sign) == std::string_view::npos;
}

// Of digits, so all that can be wrong is the size, or a minus where there is no sign.
template <class Integer>
canopen::Result<process::GivenValue> integer_of(std::string_view text) {
  Integer value{};
  if (std::from_chars(text.data(), text.data() + text.size(), value).ec != std::errc{}) {
    return Error{.kind = ErrorKind::range, .detail = std::string(text) + " is out of the type's range"};
  }
  return process::GivenValue(static_cast<canopen::Raw>(value));
}

}  // namespace

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

canopen::Result<process::GivenValue> number_in(DataType type, std::string_view text) {
  if (type == DataType::i64 && is_integer(text)) {
    return integer_of<std::int64_t>(text);
  }
  if (type == DataType::u64 && is_integer(text)) {
    return integer_of<std::uint64_t>(text == "-0" ? "0" : text);
  }
  const canopen::Result<double> number = number_of(text);
  if (number.has_error()) {
    return number.error();
  }
  return process::GivenValue(number.value());
}

}  // namespace mqtt
