#pragma once

#include <compare>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace canopen {

/// An object dictionary address (CiA 301 §7.4).
struct ObjectAddress {
  std::uint16_t index = 0;
  std::uint8_t sub = 0;

  friend auto operator<=>(const ObjectAddress&, const ObjectAddress&) = default;
};

/// `0x2021:02`: four and two upper-case hexadecimal digits.
[[nodiscard]] std::string to_string(ObjectAddress address);
/// Reads `0x2021:02`, `2021:02`, `0x1000` (sub-index 0); hexadecimal throughout. Nothing on any other text.
[[nodiscard]] std::optional<ObjectAddress> parse_object(std::string_view text);

/// The basic data types that process data are made of (CiA 301 §7.4.7).
enum class DataType : std::uint8_t { boolean, u8, u16, u32, u64, i8, i16, i32, i64, f32, f64 };

/// `bool`, `u8`, … `f64`: the names of configuration files and of `map`.
[[nodiscard]] std::string_view name_of(DataType type) noexcept;
[[nodiscard]] std::optional<DataType> parse_type(std::string_view name) noexcept;
/// 1 for a boolean, else 8 to 64.
[[nodiscard]] unsigned bit_length(DataType type) noexcept;
/// Bytes of an SDO or of Modbus: 1, 2, 4 or 8.
[[nodiscard]] unsigned byte_length(DataType type) noexcept;
[[nodiscard]] bool is_signed(DataType type) noexcept;
[[nodiscard]] bool is_real(DataType type) noexcept;

/// A value as the device holds it: two's complement, sign-extended to 64 bits; reals as their IEEE 754 bits
/// (f32 in the low 32 bits). Its meaning needs the DataType that stands beside it.
using Raw = std::uint64_t;

/// Little-endian bytes to a raw value, extended by sign. Takes the low bits where there are more bytes than the type
/// holds; nothing where there are fewer.
[[nodiscard]] std::optional<Raw> decode_raw(DataType type, std::span<const std::uint8_t> bytes) noexcept;
/// Writes byte_length(type) little-endian bytes; returns how many. `out` holds at least 8.
unsigned encode_raw(DataType type, Raw raw, std::span<std::uint8_t> out) noexcept;
/// `raw` cut to the type's bits and extended by its sign: what the device would give back.
[[nodiscard]] Raw normalise(DataType type, Raw raw) noexcept;

/// The number a raw value stands for, unscaled. Integers beyond 2^53 lose digits, as any double does.
[[nodiscard]] double to_number(DataType type, Raw raw) noexcept;
/// The nearest raw value (ties away from zero); nothing for NaN, infinity and what the type cannot hold. That is judged
/// before rounding, but for a millionth of a step: 65535.4 is no u16.
[[nodiscard]] std::optional<Raw> from_number(DataType type, double number) noexcept;

/// One object with a value: an element of a PDO, or a field of a command.
struct ObjectValue {
  ObjectAddress object;
  DataType type = DataType::u16;
  Raw raw = 0;
  friend bool operator==(const ObjectValue&, const ObjectValue&) = default;
};

}  // namespace canopen
