#include "config/toml/report.h"

#include <algorithm>
#include <set>
#include <tuple>
#include <utility>

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

std::uint16_t Report::add_file(std::string name) {
  files_.push_back(std::move(name));
  return static_cast<std::uint16_t>(files_.size() - 1);
}

void Report::error(Place place, std::string text) {
  add(place, Finding::Level::error, std::move(text));
}

void Report::warning(Place place, std::string text) {
  add(place, Finding::Level::warning, std::move(text));
}

void Report::add(Place place, Finding::Level level, std::string text) {
  // A finding is one line, whatever stood between quotation marks in the file.
  std::replace_if(
      text.begin(), text.end(), [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7F; }, '?');
  noted_.push_back({.place = place, .level = level, .text = std::move(text)});
}

bool Report::has_errors() const noexcept {
  return std::any_of(noted_.begin(), noted_.end(),
                     [](const Noted& noted) { return noted.level == Finding::Level::error; });
}

Findings Report::take() {
  std::sort(noted_.begin(), noted_.end(), [](const Noted& a, const Noted& b) {
    return std::tie(a.place.file, a.place.line, a.place.column, a.text) <
           std::tie(b.place.file, b.place.line, b.place.column, b.text);
  });
  Findings findings;
  std::set<std::string> seen;
  for (Noted& noted : noted_) {
    Finding finding{.file = files_.at(noted.place.file),
                    .line = noted.place.line,
                    .column = noted.place.column,
                    .level = noted.level,
                    .text = std::move(noted.text)};
    // Two drives of one profile meet the same mistake in it.
    if (seen.insert(to_string(finding)).second) {
      findings.push_back(std::move(finding));
    }
  }
  noted_.clear();
  return findings;
}

}  // namespace config
