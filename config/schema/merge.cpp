#include "config/schema/merge.h"

namespace config {
namespace {

bool are(NodeKind kind, const Node& one, const Node& other) {
  return one.kind == kind && other.kind == kind;
}

void lay_keys(Node& lower, const Node& upper) {
  for (const Entry& entry : upper.entries) {
    Node* const known = lower.find(entry.key);
    if (known == nullptr) {
      lower.entries.push_back(entry);
    } else if (are(NodeKind::table, *known, entry.value)) {
      lay_keys(*known, entry.value);
    } else {
      *known = entry.value;
    }
  }
}

void lay_named(Node& lower, const Node& upper, const Section& section) {
  for (const Entry& entry : upper.entries) {
    Node* const known = lower.find(entry.key);
    if (known == nullptr) {
      lower.entries.push_back(entry);
    } else if (are(NodeKind::table, *known, entry.value)) {
      lay_over(*known, entry.value, section);
    } else {
      *known = entry.value;
    }
  }
}

void lay_value(Node& lower, const Node& upper, const Key& key) {
  const bool tables = are(NodeKind::table, lower, upper);
  if (key.layering == Layering::table && tables) {
    lay_over(lower, upper, *key.below);
  } else if (key.layering == Layering::by_name && tables) {
    lay_named(lower, upper, *key.below);
  } else if (key.layering == Layering::by_key && tables) {
    lay_keys(lower, upper);
  } else if (key.layering == Layering::append && are(NodeKind::list, lower, upper)) {
    lower.items.insert(lower.items.end(), upper.items.begin(), upper.items.end());
  } else {
    lower = upper;
  }
}

}  // namespace

void lay_over(Node& lower, const Node& upper, const Section& section) {
  for (const Entry& entry : upper.entries) {
    Node* const known = lower.find(entry.key);
    const Key* const key = section.find(entry.key);
    if (known == nullptr) {
      lower.entries.push_back(entry);
    } else if (key != nullptr) {
      lay_value(*known, entry.value, *key);
    } else {
      *known = entry.value;
    }
  }
}

}  // namespace config
