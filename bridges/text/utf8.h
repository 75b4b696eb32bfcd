#pragma once

#include <string>
#include <string_view>

namespace text {

/// Well-formed UTF-8 (RFC 3629): no overlong forms, no surrogates.
[[nodiscard]] bool is_utf8(std::string_view text);
/// The same text with U+FFFD for every byte that is part of no character.
[[nodiscard]] std::string repaired_utf8(std::string_view text);

}  // namespace text
