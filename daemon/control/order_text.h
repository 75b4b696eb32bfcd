#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

// What words of the command line become in a request.

namespace gateway::control {

/// A word as a JSON value: a number, `true` and `false`, anything else a string.
[[nodiscard]] std::string json_of(std::string_view word);

/// The same for the raw value of an object, where hexadecimal digits (`0x1F`) are a number, too.
[[nodiscard]] std::string json_of_raw(std::string_view word);

/// `{"frequency_command":30.0}` of `frequency_command=30.0`; nothing where a word is no assignment.
[[nodiscard]] std::optional<std::string> values_of(const std::vector<std::string>& assignments);

}  // namespace gateway::control
