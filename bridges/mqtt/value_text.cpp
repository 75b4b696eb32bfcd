#include "bridges/mqtt/value_text.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <string_view>

namespace mqtt {
namespace {

constexpr std::array kDecimalScales{1.0,     0.1,      0.01,      0.001,      0.0001,
                                    0.00001, 0.000001, 0.0000001, 0.00000001, 0.000000001};
// More say nothing about a double.
constexpr unsigned kMaxDecimals = 17;

// The digits of an integer with a point before the last `decimals`: exact for all 64 bits.
std::string with_point(std::string digits, unsigned decimals) {
  const std::size_t sign = digits.starts_with('-') ? 1 : 0;
  if (digits.size() - sign <= decimals) {
    digits.insert(sign, sign + decimals + 1 - digits.size(), '0');
  }
  if (decimals > 0) {
    digits.insert(digits.size() - decimals, 1, '.');
  }
  return digits;
}

bool append_fixed(std::string& out, double value, unsigned decimals) {
  if (!std::isfinite(value)) {
    return false;
  }
  std::array<char, 400> digits{};  // 309 before the point, at most 17 behind
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value, std::chars_format::fixed,
                                 static_cast<int>(std::min(decimals, kMaxDecimals)));
  std::string_view text(digits.data(), static_cast<std::size_t>(end.ptr - digits.data()));
  if (text.front() == '-' && text.find_first_of("123456789") == std::string_view::npos) {
    text.remove_prefix(1);  // -0.00 is 0.00
  }
  out += text;
  return true;
}

bool append_scaled(std::string& out, const config::Signal& signal, canopen::Raw raw) {
  if (!canopen::is_real(signal.type)) {
    if (signal.decimals < kDecimalScales.size() && signal.scale == kDecimalScales.at(signal.decimals)) {
      out += with_point(integer_text(signal.type, raw), signal.decimals);
      return true;
    }
  } else if (signal.decimals == 0) {
    const double value = canopen::to_number(signal.type, raw) * signal.scale;
    return signal.type == canopen::DataType::f32 ? text::append_number(out, static_cast<float>(value))
                                                 : text::append_number(out, value);
  }
  return append_fixed(out, canopen::to_number(signal.type, raw) * signal.scale, signal.decimals);
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
  if (shape == Shape::number) {
    return append_scaled(out, signal, raw);
  }
  if (shape == Shape::boolean) {
    out += raw != 0 ? "true" : "false";
    return true;
  }
  const auto known = signal.values.find(static_cast<std::int64_t>(raw));
  out += known != signal.values.end() ? known->second : "unknown(" + integer_text(signal.type, raw) + ")";
  return true;
}

void append_member(text::ObjectText& object, const config::Signal& signal, Shape shape,
                   std::optional<canopen::Raw> raw) {
  std::string text;
  if (!raw || !append_value(text, signal, shape, *raw)) {
    object.null(signal.name);
  } else if (shape == Shape::name) {
    object.text(signal.name, text);
  } else {
    object.key(signal.name) += text;
  }
}

std::string integer_text(canopen::DataType type, canopen::Raw raw) {
  return canopen::is_signed(type) ? std::to_string(static_cast<std::int64_t>(raw)) : std::to_string(raw);
}

}  // namespace mqtt
