#pragma once

#include <string>
#include <string_view>
#include <utility>

#include "config/document.h"
#include "config/report.h"
#include "config/schema.h"

// The checks of single values and of lists; tables are walked by check().

namespace config {

/// Errors that all begin with the same words.
class Complaint {
 public:
  /// `where`: `drive "pump1"`, or empty.
  Complaint(std::string where, Report& report) : where_(std::move(where)), report_(report) {}
  void operator()(Place place, const std::string& text) const;
  [[nodiscard]] const std::string& where() const noexcept { return where_; }
  [[nodiscard]] Report& report() const noexcept { return report_; }

 private:
  std::string where_;
  Report& report_;
};

/// In quotation marks, and cut where it is long.
[[nodiscard]] std::string in_quotes(std::string_view text);

/// True, or a complaint that `path` is of another kind.
bool expect(const Node& node, NodeKind kind, const std::string& path, const Complaint& complain);
/// False where the key is of no scalar kind, and nothing was checked.
bool check_scalar(const Node& node, const Key& key, const std::string& path, const Complaint& complain);
/// A list of what the key's kind says.
void check_list(const Node& node, const Key& key, const std::string& path, const Complaint& complain);
/// Any other value than the key's default is for a later version.
void check_default_only(const Node& node, const Key& key, const std::string& path, const Complaint& complain);

}  // namespace config
