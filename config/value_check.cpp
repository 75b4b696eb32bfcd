#include "config/value_check.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

namespace config {
namespace {

using canopen::DataType;
using canopen::Error;
using canopen::ErrorKind;
using canopen::Raw;
using canopen::Result;

/// Dividing by a decimal scale leaves a trace: 50.0 / 0.01 must not count as beyond 5000. In raw steps; what a person
/// writes differs by far more.
constexpr double kStepNoise = 1e-6;
constexpr double kRelativeNoise = 1e-12;
/// A limit such as 0.1 has no exact f32: its neighbour is meant.
constexpr double kFloatNoise = std::numeric_limits<float>::epsilon();

double noise_of(const Signal& signal, double limit) {
  if (!canopen::is_real(signal.type)) {
    return std::max(kStepNoise, std::abs(limit) * kRelativeNoise);
  }
  return std::abs(limit) * (signal.type == DataType::f32 ? kFloatNoise : kRelativeNoise);
}

// `number` and the limits in raw steps.
bool within_limits(const Signal& signal, double number) {
  const auto beyond = [&](const std::optional<double>& limit, bool upper) {
    if (!limit) {
      return false;
    }
    const double steps = *limit / signal.scale;
    const double excess = upper == (signal.scale > 0) ? number - steps : steps - number;
    return excess > noise_of(signal, steps);
  };
  return !beyond(signal.min, false) && !beyond(signal.max, true);
}

Error error(ErrorKind kind, std::string detail) {
  Error error;
  error.kind = kind;
  error.detail = std::move(detail);
  return error;
}

Error out_of_range(const Signal& signal) {
  return error(ErrorKind::range, "out of range " + range_text(signal));
}

Result<Raw> check_raw(const Signal& signal, Raw raw) {
  const double number = canopen::to_number(signal.type, raw);
  if (!std::isfinite(number)) {
    return error(ErrorKind::type, "not a number");
  }
  if (canopen::normalise(signal.type, raw) != raw || !within_limits(signal, number)) {
    return out_of_range(signal);
  }
  return raw;
}

Result<Raw> check_number(const Signal& signal, double value) {
  if (!std::isfinite(value)) {
    return error(ErrorKind::type, "not a number");
  }
  const double number = value / signal.scale;
  const std::optional<Raw> raw = canopen::from_number(signal.type, number);
  if (!raw || !within_limits(signal, number)) {
    return out_of_range(signal);
  }
  return *raw;
}

std::string shortest(double value) {
  std::array<char, 32> text{};
  const auto [end, failure] = std::to_chars(text.data(), text.data() + text.size(), value);
  return failure == std::errc() ? std::string(text.data(), end) : std::string("?");
}

// A limit of the type in engineering units, without the trace that multiplying by a decimal scale leaves.
std::string type_limit(const Signal& signal, double steps) {
  const double factor = std::pow(10.0, std::min(signal.decimals, 15U));
  const double value = steps * signal.scale;
  const double rounded = std::round(value * factor) / factor;
  return shortest(std::isfinite(rounded) ? rounded : value);
}

std::pair<double, double> type_limits(DataType type) {
  if (type == DataType::f32) {
    const auto limit = static_cast<double>(std::numeric_limits<float>::max());
    return {-limit, limit};
  }
  if (type == DataType::f64) {
    return {std::numeric_limits<double>::lowest(), std::numeric_limits<double>::max()};
  }
  const auto bits = static_cast<int>(canopen::bit_length(type));
  return canopen::is_signed(type) ? std::pair(-std::ldexp(1.0, bits - 1), std::ldexp(1.0, bits - 1) - 1)
                                  : std::pair(0.0, std::ldexp(1.0, bits) - 1);
}

}  // namespace

Result<Raw> check_value(const Signal& signal, const std::variant<Raw, double>& value) {
  if (const Raw* raw = std::get_if<Raw>(&value)) {
    return check_raw(signal, *raw);
  }
  return check_number(signal, std::get<double>(value));
}

std::string range_text(const Signal& signal) {
  auto [low, high] = type_limits(signal.type);
  if (signal.scale < 0) {
    std::swap(low, high);
  }
  return (signal.min ? shortest(*signal.min) : type_limit(signal, low)) + ".." +
         (signal.max ? shortest(*signal.max) : type_limit(signal, high));
}

}  // namespace config
