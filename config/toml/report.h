#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace config {

/// Where something stands in one of the files that make up a configuration.
struct Place {
  std::uint16_t file = 0;  ///< Position in the Report's list of files; 0: the site's own.
  std::uint32_t line = 0;  ///< From 1; 0: the file as a whole.
  std::uint32_t column = 0;
};

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

/// Collects the findings of one load over all its files.
class Report {
 public:
  /// The number that goes into the places of this file's values.
  std::uint16_t add_file(std::string name);

  void error(Place place, std::string text);
  void warning(Place place, std::string text);

  [[nodiscard]] bool has_errors() const noexcept;
  /// All findings in order of file, line and column, none twice.
  [[nodiscard]] Findings take();

 private:
  struct Noted {
    Place place;
    Finding::Level level;
    std::string text;
  };
  void add(Place place, Finding::Level level, std::string text);

  std::vector<std::string> files_;
  std::vector<Noted> noted_;
};

}  // namespace config
