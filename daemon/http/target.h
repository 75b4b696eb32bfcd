#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace gateway::http {

struct Parameter {
  std::string name;
  std::string value;
};

/// What a request names, decoded: `/api/commands?count=5`.
struct Target {
  std::string host{};  ///< Of the absolute form, `http://HOST/PATH`; else empty.
  std::string path;    ///< Begins with a slash.
  std::vector<Parameter> parameters{};

  /// The first of that name; null: there is none.
  [[nodiscard]] const std::string* find(std::string_view name) const noexcept;
};

/// Why a target is none: the byte, from 1, and what to write instead.
struct TargetMistake {
  std::string text;
};

/// Takes a target apart (RFC 9112, section 3.2, RFC 3986). Any bytes.
[[nodiscard]] std::variant<Target, TargetMistake> parse_target(std::string_view text);

}  // namespace gateway::http
