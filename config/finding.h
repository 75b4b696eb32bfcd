#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace config {

/// One thing wrong, or doubtful, in a configuration or profile.
struct Finding {
  enum class Level : std::uint8_t { error, warning };
  std::string file;
  std::uint32_t line = 0;  ///< From 1; 0: the file as a whole.
  std::uint32_t column = 0;
  Level level = Level::error;
  std::string text;
};

using Findings = std::vector<Finding>;

/// `gateway.toml:12:8: error: drive "pump1": node 300 is out of range 1..127`
[[nodiscard]] std::string to_string(const Finding& finding);
[[nodiscard]] bool has_errors(const Findings& findings) noexcept;

}  // namespace config
