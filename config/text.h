#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "canopen/clock.h"
#include "canopen/object.h"

// Small readers and writers of the notations that configuration files use. None throws on any text.

namespace config {

/// `500ms`, `1.5s`, `10min`; units us, ms, s, min, h. Nothing on any other text, negative ones, and beyond ten years.
[[nodiscard]] std::optional<canopen::Duration> parse_duration(std::string_view text);
/// The shortest of these notations without a fraction where one exists: `500ms`, `90s`, `10min`.
[[nodiscard]] std::string to_text(canopen::Duration duration);

/// What the objects of CiA 301 that hold a time in milliseconds can say.
[[nodiscard]] bool whole_milliseconds(canopen::Duration duration) noexcept;

/// `50MB`, `1.5GB`; units B, kB, MB, GB, each 1000 times the one before. Whole bytes, at most a million GB; nothing on
/// any other text.
[[nodiscard]] std::optional<std::uint64_t> parse_size(std::string_view text);
/// The shortest of these notations without a fraction: `50MB`, `1500kB`.
[[nodiscard]] std::string size_text(std::uint64_t bytes);

/// Decimal or 0x…; the whole text must be a number.
[[nodiscard]] std::optional<std::int64_t> parse_integer(std::string_view text);
/// The shortest decimal text that reads back as the same number, never with an exponent below 1e15: `0.01`, `50`.
[[nodiscard]] std::string to_text(double number);
/// At least four hexadecimal digits: `0x0005`.
[[nodiscard]] std::string to_hex(std::uint64_t number);

/// The rule for gateway, bus and drive names: [A-Za-z0-9_-]{1,32}.
[[nodiscard]] bool is_name(std::string_view text) noexcept;
/// The rule for signal names: [a-z][a-z0-9_]*, at most 64 characters.
[[nodiscard]] bool is_signal_name(std::string_view text) noexcept;
inline constexpr std::string_view kSignalNameRule = "lower case letters, digits and '_', beginning with a letter";
/// Free text: no control characters, at most 200 bytes.
[[nodiscard]] bool is_plain_text(std::string_view text) noexcept;

/// `0x2021:02`, hexadecimal with its 0x; without a sub-index 0 is meant.
[[nodiscard]] std::optional<canopen::ObjectAddress> parse_stated_object(std::string_view text);
/// `0x2021:02 u16`: an object as a PDO maps it.
[[nodiscard]] std::optional<std::pair<canopen::ObjectAddress, canopen::DataType>> parse_mapped(std::string_view text);
/// A COB-ID as it is stated: a number, or one that the node id is added to.
struct CobId {
  std::int64_t base = 0;
  bool plus_node = false;
  friend bool operator==(const CobId&, const CobId&) = default;
};
/// `$NODEID+0x180`, `0x180+$NODEID`, or a plain number, 1..0x7FF.
[[nodiscard]] std::optional<CobId> parse_cob_id(std::string_view text);
/// A decimal number without a sign, and without a leading 0 unless it is 0.
[[nodiscard]] std::optional<std::int64_t> parse_decimal(std::string_view text);

}  // namespace config
