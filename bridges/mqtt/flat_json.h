#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "canopen/error.h"

namespace mqtt {

/// A value as it was written: numbers keep their digits, so that 64 bits stay 64 bits.
struct Scalar {
  enum class Kind : std::uint8_t { null, boolean, number, string };
  Kind kind = Kind::null;
  std::string text;  ///< Digits, the string's characters, or `true` / `false`.
  friend bool operator==(const Scalar&, const Scalar&) = default;
};

/// Members in the order in which they stand.
using FlatObject = std::vector<std::pair<std::string, Scalar>>;

/// Reads a JSON object whose members are single values. Refused as `type`, with the position: text that is no JSON,
/// anything but an object, nested objects and lists, a name given twice.
[[nodiscard]] canopen::Result<FlatObject> parse_flat(std::string_view text);

}  // namespace mqtt
