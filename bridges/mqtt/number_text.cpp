#include "bridges/mqtt/number_text.h"

#include <charconv>
#include <cmath>
#include <string>

namespace mqtt {
namespace {

using canopen::DataType;
using canopen::Error;
using canopen::ErrorKind;

template <class Integer>
canopen::Result<canopen::Raw> integer_of(std::string_view text) {
  Integer value{};
  const auto end = std::from_chars(text.data(), text.data() + text.size(), value);
  // Digits only, so all that can be wrong is the size, or a minus where there is no sign.
  if (end.ec != std::errc{} || end.ptr != text.data() + text.size()) {
    return Error{.kind = ErrorKind::range, .detail = std::string(text) + " is out of the type's range"};
  }
  return static_cast<canopen::Raw>(value);
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

std::optional<canopen::Result<canopen::Raw>> exact_integer(DataType type, std::string_view text) {
  const std::size_t sign = text.starts_with('-') ? 1 : 0;
  const bool whole = text.size() > sign && text.find_first_not_of("0123456789", sign) == std::string_view::npos;
  if (!whole) {
    return std::nullopt;
  }
  if (type == DataType::i64) {
    return integer_of<std::int64_t>(text);
  }
  if (type == DataType::u64) {
    return text == "-0" ? canopen::Result<canopen::Raw>(canopen::Raw{0}) : integer_of<std::uint64_t>(text);
  }
  return std::nullopt;
}

}  // namespace mqtt
