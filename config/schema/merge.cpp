#include "config/schema/merge.h"

#include <algorithm>

#include "config/text.h"

namespace config {
namespace {

/// The entry of that key, where it stands for a number also in another spelling; null where there is none.
Entry* find_same(Node& table, const std::string& key) {
  Entry* const exact = table.find_entry(key);
  const auto number = parse_integer(key);
  if (exact != nullptr || !number.has_value()) {
    return exact;
  }
  const auto found = std::find_if(table.entries.begin(), table.entries.end(),
                                  [&number](const Entry& entry) { return parse_integer(entry.key) == number; });
  return found == table.entries.end() ? nullptr : &*found;
}

/// Lays the entries of a table over those of one that must be one, too, each by `lay`. What is no table has its finding
/// and counts as left out.
template <class Lay>
void lay_entries(Node& lower, const Node& upper, Lay lay) {
  if (lower.kind != NodeKind::table) {
    lower = upper;
    return;
  }
  for (const Entry& entry : upper.entries) {
    if (Entry* const known = find_same(lower, entry.key); known != nullptr) {
      known->key_place = entry.key_place;
      lay(known->value, entry);
    } else {
      lower.entries.push_back(entry);
    }
  }
}

void lay_plain(Node& lower, const Entry& upper) {
  if (lower.kind == NodeKind::table && upper.value.kind == NodeKind::table) {
    lay_entries(lower, upper.value, lay_plain);
  } else {
    lower = upper.value;
  }
}

void lay_value(Node& lower, const Node& upper, const Key* key) {
  switch (key == nullptr ? Layering::replace : key->layering) {
    case Layering::table:
      return lay_over(lower, upper, *key->below);
    case Layering::by_name:
      return lay_entries(lower, upper,
                         [key](Node& known, const Entry& entry) { lay_over(known, entry.value, *key->below); });
    case Layering::by_key:
      return lay_entries(lower, upper, lay_plain);
    case Layering::append:
      if (lower.kind == NodeKind::list && upper.kind == NodeKind::list) {
        lower.items.insert(lower.items.end(), upper.items.begin(), upper.items.end());
        return;
      }
      break;
    case Layering::replace:
      break;
  }
  lower = upper;
}

}  // namespace

void lay_over(Node& lower, const Node& upper, const Section& section) {
  lay_entries(lower, upper,
              [&section](Node& known, const Entry& entry) { lay_value(known, entry.value, section.find(entry.key)); });
}

}  // namespace config
