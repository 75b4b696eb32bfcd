#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "config/document.h"
#include "config/finding.h"

namespace config {

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
