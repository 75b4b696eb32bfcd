#include <algorithm>

#include "config/text.h"
#include "config/toml/document.h"

namespace config {
namespace {

const Node* of_kind(const Node& table, std::string_view key, NodeKind kind) {
  const Node* const node = table.find(key);
  return node != nullptr && node->kind == kind ? node : nullptr;
}

std::vector<const Node*> items_of_kind(const Node& table, std::string_view key, NodeKind kind) {
  std::vector<const Node*> items;
  if (const Node* const list = of_kind(table, key, NodeKind::list); list != nullptr) {
    for (const Node& item : list->items) {
      if (item.kind == kind) {
        items.push_back(&item);
      }
    }
  }
  return items;
}

}  // namespace

std::optional<std::string> read_text(const Node& table, std::string_view key) {
  const Node* const node = of_kind(table, key, NodeKind::text);
  return node == nullptr ? std::nullopt : std::optional(node->text);
}

std::vector<const Node*> read_texts(const Node& table, std::string_view key) {
  return items_of_kind(table, key, NodeKind::text);
}

const Node* read_table(const Node& table, std::string_view key) {
  return of_kind(table, key, NodeKind::table);
}

std::vector<const Node*> read_tables(const Node& table, std::string_view key) {
  return items_of_kind(table, key, NodeKind::table);
}

std::vector<std::pair<std::int64_t, const Entry*>> read_numbered(const Node& table) {
  std::vector<std::pair<std::int64_t, const Entry*>> numbered;
  for (const Entry& entry : table.entries) {
    if (const auto number = parse_integer(entry.key); number.has_value()) {
      numbered.emplace_back(*number, &entry);
    }
  }
  // Entries keep their order, and stand in one piece of memory.
  std::sort(numbered.begin(), numbered.end());
  return numbered;
}

Place place_of(const Node& table, std::string_view key) {
  const Node* const node = table.find(key);
  return node == nullptr ? table.place : node->place;
}

Place in_the_site(Place first, Place second) noexcept {
  return first.file != 0 && second.file == 0 ? second : first;
}

}  // namespace config
