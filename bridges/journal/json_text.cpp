#include "bridges/journal/json_text.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include "bridges/text/json_text.h"

namespace journal {
namespace {

// Bounds a line: whoever gives a command chooses its id.
constexpr std::size_t kMaxText = 1000;
// More say nothing about a double.
constexpr unsigned kMaxDecimals = 17;

// Decimals: exactly so many; nothing: as few as stand for the number.
void append_number(std::string& out, double number, std::optional<unsigned> decimals) {
  if (!std::isfinite(number)) {
    out += "null";
    return;
  }
  std::array<char, 400> digits{};  // 309 before the point, at most 17 behind
  char* const begin = digits.data();
  char* const end = begin + digits.size();
  const auto written = decimals
                           ? std::to_chars(begin, end, number, std::chars_format::fixed, static_cast<int>(*decimals))
                           : std::to_chars(begin, end, number);
  out.append(begin, written.ptr);
}

}  // namespace

void append_text(std::string& out, std::string_view text) {
  text::append_quoted(out, text.substr(0, kMaxText));
}

void append_given(std::string& out, std::optional<double> number) {
  append_number(out, number.value_or(std::nan("")), std::nullopt);
}

void append_value(std::string& out, const config::Signal& signal, canopen::Raw raw) {
  const bool real = canopen::is_real(signal.type);
  if (!real && signal.scale == 1.0) {
    append_raw(out, signal.type, raw);
    return;
  }
  const double number = canopen::to_number(signal.type, raw) * signal.scale;
  append_number(out, number,
                real && signal.decimals == 0 ? std::nullopt : std::optional(std::min(signal.decimals, kMaxDecimals)));
}

void append_raw(std::string& out, canopen::DataType type, canopen::Raw raw) {
  if (type == canopen::DataType::boolean) {
    out += raw != 0 ? "true" : "false";
  } else if (canopen::is_real(type)) {
    append_number(out, canopen::to_number(type, raw), std::nullopt);
  } else {
    out += canopen::is_signed(type) ? std::to_string(static_cast<std::int64_t>(raw)) : std::to_string(raw);
  }
}

}  // namespace journal
