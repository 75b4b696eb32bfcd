#include "config/finding.h"

#include <algorithm>

namespace config {

std::string to_string(const Finding& finding) {
  std::string text = finding.file;
  if (finding.line != 0) {
    text += ':' + std::to_string(finding.line) + ':' + std::to_string(finding.column);
  }
  text += finding.level == Finding::Level::error ? ": error: " : ": warning: ";
  return text + finding.text;
}

bool has_errors(const Findings& findings) noexcept {
  return std::any_of(findings.begin(), findings.end(),
                     [](const Finding& finding) { return finding.level == Finding::Level::error; });
}

}  // namespace config
