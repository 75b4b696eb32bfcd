#include "bridges/mqtt/value_text.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <string_view>

#include "bridges/text/json_text.h"

namespace mqtt {
namespace {

constexpr std::array kDecimalScales{1.0,     0.1,      0.01,      0.001,      0.0001,
                                    0.00001, 0.000001, 0.0000001, 0.00000001, 0.000000001};
// More say nothing about a double.
constexpr unsigned kMaxDecimals = 17;

// The digits of an integer with a point before the last `decimals`: exact for all 64 bits.
void append_decimal(std::string& out, std::string digits, unsigned decimals) {
  const bool negative = digits.front() == '-';
  if (negative) {
    digits.erase(0, 1);
    out += '-';
  }
  if (digits.size() <= decimals) {
    digits.insert(0, decimals + 1 - digits.size(), '0');
  }
  out.append(digits, 0, digits.size() - decimals);
  if (decimals > 0) {
    out += '.';
    out.append(digits, digits.size() - decimals, decimals);
  }
}

bool is_zero(std::string_view digits) {
  return digits.find_first_of("123456789") == std::string_view::npos;
}

bool append_fixed(std::string& out, double value, unsigned decimals) {
  if (!std::isfinite(value)) {
    return false;
  }
  std::array<char, 400> digits{};  // 309 before the point, at most 17 behind
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value, std::chars_format::fixed,
                                 static_cast<int>(std::min(decimals, kMaxDecimals)));
  std::string_view text(digits.data(), static_cast<std::size_t>(end.ptr - digits.data()));
  if (text.front() == '-' && is_zero(text)) {
    text.remove_prefix(1);  // -0.00 is 0.00
  }
  out += text;
  return true;
}

bool append_scaled(std::string& out, const config::Signal& signal, canopen::Raw raw) {
  if (!canopen::is_real(signal.type)) {
    if (signal.decimals < kDecimalScales.size() && signal.scale == kDecimalScales.at(signal.decimals)) {
      append_decimal(out, integer_text(signal.type, raw), signal.decimals);
      return true;
    }
  } else if (signal.decimals == 0) {
    const double value = canopen::to_number(signal.type, raw) * signal.scale;
    return signal.type == canopen::DataType::f32 ? text::append_number(out, static_cast<float>(value))
                                                 : text::append_number(out, value);
  }
  return append_fixed(out, canopen::to_number(signal.type, raw) * signal.scale, signal.decimals);
}

void append_name(std::string& out, const config::Signal& signal, canopen::Raw raw) {
  const auto known = signal.values.find(static_cast<std::int64_t>(raw));
  if (known != signal.values.end()) {
    out += known->second;
    return;
  }
  out += "unknown(";
  out += integer_text(signal.type, raw);
  out += ')';
}

}  // namespace

Shape shape_of(const config::Drive& drive, process::SignalId signal) {
  const config::Signal& model = drive.signals.at(signal);
  if (drive.faults.fault_code == std::size_t{signal} || model.name == "fault_code") {
    return Shape::number;
  }
  if (!model.values.empty()) {
    return Shape::name;
  }
  return model.derived || model.type == canopen::DataType::boolean ? Shape::boolean : Shape::number;
}

bool append_value(std::string& out, const config::Signal& signal, Shape shape, canopen::Raw raw) {
  switch (shape) {
    case Shape::boolean:
      out += raw != 0 ? "true" : "false";
      return true;
    case Shape::name:
      append_name(out, signal, raw);
      return true;
    case Shape::number:
      break;
  }
  return append_scaled(out, signal, raw);
}

std::string integer_text(canopen::DataType type, canopen::Raw raw) {
  return canopen::is_signed(type) ? std::to_string(static_cast<std::int64_t>(raw)) : std::to_string(raw);
}

}  // namespace mqtt
