#include "canopen/object.h"

#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <limits>

#include "canopen/hex.h"

namespace canopen {
namespace {

struct TypeTraits {
  DataType type;
  std::string_view name;
  unsigned bits;
  bool is_signed;
  bool is_real;
};

// In the order of the enumerators, so that a type is its own index.
constexpr std::array kTypes{
    TypeTraits{DataType::boolean, "bool", 1, false, false}, TypeTraits{DataType::u8, "u8", 8, false, false},
    TypeTraits{DataType::u16, "u16", 16, false, false},     TypeTraits{DataType::u32, "u32", 32, false, false},
    TypeTraits{DataType::u64, "u64", 64, false, false},     TypeTraits{DataType::i8, "i8", 8, true, false},
    TypeTraits{DataType::i16, "i16", 16, true, false},      TypeTraits{DataType::i32, "i32", 32, true, false},
    TypeTraits{DataType::i64, "i64", 64, true, false},      TypeTraits{DataType::f32, "f32", 32, false, true},
    TypeTraits{DataType::f64, "f64", 64, false, true}};

const TypeTraits& traits(DataType type) noexcept {
  return kTypes[static_cast<std::size_t>(type)];
}

template <class Number>
std::optional<Number> parse_hex(std::string_view text, std::size_t max_digits) {
  Number number{};
  const char* end = text.data() + text.size();
  const auto [stopped_at, error] = std::from_chars(text.data(), end, number, 16);
  if (text.empty() || text.size() > max_digits || error != std::errc() || stopped_at != end) {
    return std::nullopt;
  }
  return number;
}

// A division by a decimal scale leaves a trace: 655.35 / 0.01 must not count as beyond 65535.
constexpr double kRoundingNoise = 1e-6;

std::optional<Raw> integer_from(DataType type, double number) noexcept {
  const auto bits = static_cast<int>(bit_length(type));
  const double limit = std::ldexp(1.0, is_signed(type) ? bits - 1 : bits);  // The first number too large.
  const double lowest = is_signed(type) ? -limit : 0.0;
  // Judged before rounding: 65535.4 is no u16.
  if (number < lowest - kRoundingNoise || number > limit - 1.0 + kRoundingNoise) {
    return std::nullopt;
  }
  const double rounded = std::round(number);
  // With 64 bits `limit - 1.0` is `limit` itself, which a cast could not hold.
  if (rounded >= limit) {
    return std::nullopt;
  }
  return is_signed(type) ? static_cast<Raw>(static_cast<std::int64_t>(rounded)) : static_cast<Raw>(rounded);
}

}  // namespace

std::string to_string(ObjectAddress address) {
  return "0x" + hex(address.index, 4) + ":" + hex(address.sub, 2);
}

std::optional<ObjectAddress> parse_object(std::string_view text) {
  if (text.starts_with("0x") || text.starts_with("0X")) {
    text.remove_prefix(2);
  }
  const std::size_t colon = text.find(':');
  const auto index = parse_hex<std::uint16_t>(text.substr(0, colon), 4);
  if (!index) {
    return std::nullopt;
  }
  if (colon == std::string_view::npos) {
    return ObjectAddress{*index, 0};
  }
  const auto sub = parse_hex<std::uint8_t>(text.substr(colon + 1), 2);
  if (!sub) {
    return std::nullopt;
  }
  return ObjectAddress{*index, *sub};
}

std::string_view name_of(DataType type) noexcept {
  return traits(type).name;
}

std::optional<DataType> parse_type(std::string_view name) noexcept {
  for (const TypeTraits& known : kTypes) {
    if (known.name == name) {
      return known.type;
    }
  }
  return std::nullopt;
}

unsigned bit_length(DataType type) noexcept {
  return traits(type).bits;
}

unsigned byte_length(DataType type) noexcept {
  return (traits(type).bits + 7) / 8;
}

bool is_signed(DataType type) noexcept {
  return traits(type).is_signed;
}

bool is_real(DataType type) noexcept {
  return traits(type).is_real;
}

std::optional<Raw> decode_raw(DataType type, std::span<const std::uint8_t> bytes) noexcept {
  const std::size_t count = byte_length(type);
  if (bytes.size() < count) {
    return std::nullopt;
  }
  Raw raw = 0;
  for (std::size_t i = 0; i < count; ++i) {
    raw |= Raw{bytes[i]} << (8 * i);
  }
  return normalise(type, raw);
}

unsigned encode_raw(DataType type, Raw raw, std::span<std::uint8_t> out) noexcept {
  const unsigned count = byte_length(type);
  const Raw value = normalise(type, raw);
  for (unsigned i = 0; i < count; ++i) {
    out[i] = static_cast<std::uint8_t>(value >> (8 * i));
  }
  return count;
}

Raw normalise(DataType type, Raw raw) noexcept {
  const unsigned bits = bit_length(type);
  if (bits == 64) {
    return raw;
  }
  const Raw kept = raw & ((Raw{1} << bits) - 1);
  if (!is_signed(type)) {
    return kept;
  }
  const Raw sign = Raw{1} << (bits - 1);
  return (kept ^ sign) - sign;
}

double to_number(DataType type, Raw raw) noexcept {
  const Raw value = normalise(type, raw);
  if (type == DataType::f32) {
    return static_cast<double>(std::bit_cast<float>(static_cast<std::uint32_t>(value)));
  }
  if (type == DataType::f64) {
    return std::bit_cast<double>(value);
  }
  return is_signed(type) ? static_cast<double>(static_cast<std::int64_t>(value)) : static_cast<double>(value);
}

std::optional<Raw> from_number(DataType type, double number) noexcept {
  if (!std::isfinite(number)) {
    return std::nullopt;
  }
  if (type == DataType::f64) {
    return std::bit_cast<Raw>(number);
  }
  if (type == DataType::f32) {
    if (std::abs(number) > static_cast<double>(std::numeric_limits<float>::max())) {
      return std::nullopt;
    }
    return Raw{std::bit_cast<std::uint32_t>(static_cast<float>(number))};
  }
  return integer_from(type, number);
}

}  // namespace canopen
