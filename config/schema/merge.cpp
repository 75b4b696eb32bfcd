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

/// Lays a table over one that must be one, too; what is none has its finding and counts as left out.
template <class Lay>
void lay_table(Node& lower, const Node& upper, Lay lay) {
  if (are(NodeKind::table, lower, upper)) {
    lay();
  } else if (lower.kind != NodeKind::table) {
    lower = upper;
  }
}

void lay_named(Node& lower, const Node& upper, const Section& section) {
  for (const Entry& entry : upper.entries) {
    Entry* const known = lower.find_entry(entry.key);
    if (known == nullptr) {
      lower.entries.push_back(entry);
      continue;
    }
    known->key_place = entry.key_place;
    lay_table(known->value, entry.value, [&] { lay_over(known->value, entry.value, section); });
  }
}

void lay_value(Node& lower, const Node& upper, const Key& key) {
  if (key.layering == Layering::table) {
    lay_table(lower, upper, [&] { lay_over(lower, upper, *key.below); });
  } else if (key.layering == Layering::by_name) {
    lay_table(lower, upper, [&] { lay_named(lower, upper, *key.below); });
  } else if (key.layering == Layering::by_key) {
    lay_table(lower, upper, [&] { lay_keys(lower, upper); });
  } else if (key.layering == Layering::append && are(NodeKind::list, lower, upper)) {
    lower.items.insert(lower.items.end(), upper.items.begin(), upper.items.end());
  } else {
    lower = upper;
  }
}

}  // namespace

void lay_over(Node& lower, const Node& upper, const Section& section) {
  for (const Entry& entry : upper.entries) {
    Entry* const known = lower.find_entry(entry.key);
    const Key* const key = section.find(entry.key);
    if (known == nullptr) {
      lower.entries.push_back(entry);
      continue;
    }
    known->key_place = entry.key_place;
    if (key != nullptr) {
      lay_value(known->value, entry.value, *key);
    } else {
      known->value = entry.value;
    }
  }
}

}  // namespace config
