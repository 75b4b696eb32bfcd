#pragma once

#include <cstdint>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "canopen/error.h"

namespace text {

/// A value as it was written: numbers keep their digits, so that 64 bits stay 64 bits.
struct Scalar {
  enum class Kind : std::uint8_t { null, boolean, number, string };
  Kind kind = Kind::null;
  std::string text;  ///< Digits, the string's characters, or `true` / `false`.
  friend bool operator==(const Scalar&, const Scalar&) = default;
};

/// Members in the order in which they stand.
using FlatObject = std::vector<std::pair<std::string, Scalar>>;

/// The value of this member; null: there is none.
[[nodiscard]] const Scalar* find_member(const FlatObject& members, std::string_view name);
/// Its characters, where it is there and a string; else null.
[[nodiscard]] const std::string* find_string(const FlatObject& members, std::string_view name);
/// A member that is not known is a mistake; a command with a mistake is not carried out. `known` beside `id`.
[[nodiscard]] std::optional<canopen::Error> unknown_member(const FlatObject& members,
                                                           std::initializer_list<std::string_view> known);
/// An id as it is echoed, as JSON text; nothing where it is neither a string nor a number.
[[nodiscard]] std::optional<std::string> echoed_id(const Scalar& id);

/// Reads a JSON object whose members are single values. Refused as `type`, with the position: text that is no JSON,
/// anything but an object, nested objects and lists, a name given twice.
[[nodiscard]] canopen::Result<FlatObject> parse_flat(std::string_view text);

/// An object one of whose members may be such an object itself.
struct NestedObject {
  FlatObject members;               ///< Without the inner object.
  std::optional<FlatObject> inner;  ///< Nothing where the member is missing, or no object (then it is in `members`).
};

/// Reads a JSON object like parse_flat(), but its member called `inner` may be an object of single values.
[[nodiscard]] canopen::Result<NestedObject> parse_nested(std::string_view text, std::string_view inner);

}  // namespace text
