#include "config/merge.h"

#include <string_view>

namespace config {
namespace {

/// Tables that make sense only as a whole: half of the drive's and half of the site's names would mislead.
bool is_one_value(std::string_view key) {
  return key == "values" || key == "settings" || key == "returns" || key == "standard";
}

}  // namespace

void lay_over(Node& lower, const Node& upper) {
  for (const Entry& entry : upper.entries) {
    Node* const known = lower.find(entry.key);
    if (known == nullptr) {
      lower.entries.push_back(entry);
    } else if (known->kind == NodeKind::table && entry.value.kind == NodeKind::table && !is_one_value(entry.key)) {
      lay_over(*known, entry.value);
    } else if (known->kind == NodeKind::list && entry.value.kind == NodeKind::list && entry.key == "setup") {
      known->items.insert(known->items.end(), entry.value.items.begin(), entry.value.items.end());
    } else {
      *known = entry.value;
    }
  }
}

}  // namespace config
