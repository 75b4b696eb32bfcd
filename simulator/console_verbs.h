#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "simulator/drive.h"

namespace simulator {

using Arguments = std::span<const std::string_view>;

/// One order of the console.
struct Verb {
  std::string_view name;
  std::size_t least;  ///< arguments
  std::size_t most;
  bool needs_power;
  std::string_view usage;
  std::string_view help;
  /// Answers the error, or nothing when the order is carried out. Null for what the console answers itself.
  std::optional<std::string> (*handler)(Drive&, Arguments);
};

[[nodiscard]] std::span<const Verb> console_verbs();
[[nodiscard]] const Verb* find_console_verb(std::string_view name);

[[nodiscard]] std::vector<std::string_view> words_of(std::string_view line);
/// Decimal, or hexadecimal after 0x; nothing when it is no number or greater than `greatest`.
[[nodiscard]] std::optional<std::uint32_t> parse_number(std::string_view text, std::uint32_t greatest);
/// "WHAT expected, not "GOT""
[[nodiscard]] std::string expected(std::string_view what, std::string_view got);

}  // namespace simulator
