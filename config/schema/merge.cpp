#include "config/schema/merge.h"

#include <functional>

#include "config/text.h"

namespace config {
namespace {

using LayValue = std::function<void(Node& lower, const Entry& upper)>;

bool are(NodeKind kind, const Node& one, const Node& other) {
  return one.kind == kind && other.kind == kind;
}

/// The value of that key, where it stands for a number also in another spelling; null where there is none.
Node* find_same(Node& table, const std::string& key) {
  if (Node* const exact = table.find(key); exact != nullptr) {
    return exact;
  }
  const auto number = parse_integer(key);
  for (Entry& entry : table.entries) {
    if (number.has_value() && parse_integer(entry.key) == number) {
      return &entry.value;
    }
  }
  return nullptr;
}

/// Adds what is new, and lays the rest by `lay` where both are tables or lists; else the upper one replaces it.
void lay_entries(Node& lower, const Node& upper, const LayValue& lay) {
  for (const Entry& entry : upper.entries) {
    Node* const known = find_same(lower, entry.key);
    if (known == nullptr) {
      lower.entries.push_back(entry);
    } else if (are(NodeKind::table, *known, entry.value) || are(NodeKind::list, *known, entry.value)) {
      lay(*known, entry);
    } else {
      *known = entry.value;
    }
  }
}

void lay_keys(Node& lower, const Entry& upper) {
  if (upper.value.kind == NodeKind::table) {
    lay_entries(lower, upper.value, lay_keys);
  } else {
    lower = upper.value;
  }
}

void lay_value(Node& lower, const Node& upper, const Key* key) {
  const Layering layering = key == nullptr ? Layering::replace : key->layering;
  const bool tables = upper.kind == NodeKind::table;
  if (layering == Layering::table && tables) {
    lay_over(lower, upper, *key->below);
  } else if (layering == Layering::by_name && tables) {
    lay_entries(lower, upper, [key](Node& known, const Entry& entry) { lay_over(known, entry.value, *key->below); });
  } else if (layering == Layering::by_key && tables) {
    lay_entries(lower, upper, lay_keys);
  } else if (layering == Layering::append && !tables) {
    lower.items.insert(lower.items.end(), upper.items.begin(), upper.items.end());
  } else {
    lower = upper;
  }
}

}  // namespace

void lay_over(Node& lower, const Node& upper, const Section& section) {
  lay_entries(lower, upper,
              [&section](Node& known, const Entry& entry) { lay_value(known, entry.value, section.find(entry.key)); });
}

}  // namespace config
