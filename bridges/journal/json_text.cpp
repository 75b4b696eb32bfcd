#include "bridges/journal/json_text.h"

#include <algorithm>
#include <array>
#include <boost/json/parse.hpp>
#include <boost/json/serialize.hpp>
#include <charconv>
#include <cmath>

namespace journal {
namespace {

namespace json = boost::json;

// Bounds a line: whoever gives a command chooses its id.
constexpr std::size_t kMaxText = 1000;
// More say nothing about a double.
constexpr unsigned kMaxDecimals = 17;

bool is_plain(char character) {
  return character >= ' ' && character <= '~' && character != '"' && character != '\\';
}

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
  std::string plain(text.substr(0, kMaxText));
  if (!std::all_of(plain.begin(), plain.end(), is_plain)) {
    const std::string quoted = json::serialize(json::string_view(plain.data(), plain.size()));
    json::error_code failure;
    (void)json::parse(quoted, failure);
    if (!failure) {
      out += quoted;
      return;
    }
    std::replace_if(plain.begin(), plain.end(), [](char each) { return !is_plain(each); }, '?');
  }
  out += '"' + plain + '"';
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
