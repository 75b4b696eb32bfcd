#pragma once

#include <string>
#include <string_view>
#include <utility>

#include "config/toml/report.h"

namespace config {

/// Errors about one value, or about the table around it, that all begin with the same words.
class Complaint {
 public:
  /// `where`: `drive "pump1"`, or empty.
  Complaint(std::string where, Report& report) : where_(std::move(where)), report_(&report) {}
  /// One that is told to nobody: for reading what was checked before.
  [[nodiscard]] static Complaint silent() { return {}; }

  /// `drive "pump1": commands.deadline TEXT`
  void value(Place place, const std::string& text) const { tell(place, path_ + " " + text); }
  /// `drive "pump1": TEXT`
  void tell(Place place, const std::string& text) const {
    if (report_ != nullptr) {
      report_->error(place, where_.empty() ? text : where_ + ": " + text);
    }
  }

  /// The same about a key of the table that this one is about.
  [[nodiscard]] Complaint at(std::string_view key) const;
  /// The same about one table of a list, which has a name or a number: `drive "pump1"`.
  [[nodiscard]] Complaint within(std::string_view label) const;

  /// `commands.deadline`; empty at the root.
  [[nodiscard]] const std::string& path() const noexcept { return path_; }
  /// What stands between the brackets above such a table: `drive.commands`.
  [[nodiscard]] const std::string& heading() const noexcept { return heading_; }
  [[nodiscard]] bool at_root() const noexcept { return path_.empty() && where_.empty(); }

 private:
  Complaint() = default;

  std::string where_;
  std::string path_;
  std::string heading_;
  Report* report_ = nullptr;
};

/// In quotation marks, and cut where it is long.
[[nodiscard]] std::string in_quotes(std::string_view text);

}  // namespace config
