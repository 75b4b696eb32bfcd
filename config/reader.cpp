#include "config/reader.h"

#include <algorithm>
#include <cmath>

#include "config/text.h"

namespace config {
namespace {

const Node* of_kind(const Node& table, std::string_view key, NodeKind kind) {
  const Node* const node = table.find(key);
  return node != nullptr && node->kind == kind ? node : nullptr;
}

}  // namespace

std::optional<bool> read_boolean(const Node& table, std::string_view key) {
  const Node* const node = of_kind(table, key, NodeKind::boolean);
  return node == nullptr ? std::nullopt : std::optional(node->boolean);
}

std::optional<std::int64_t> read_integer(const Node& table, std::string_view key) {
  const Node* const node = of_kind(table, key, NodeKind::integer);
  return node == nullptr ? std::nullopt : std::optional(node->integer);
}

std::optional<double> read_number(const Node& table, std::string_view key) {
  if (const Node* const node = of_kind(table, key, NodeKind::number); node != nullptr) {
    return std::isfinite(node->number) ? std::optional(node->number) : std::nullopt;
  }
  const auto integer = read_integer(table, key);
  return integer.has_value() ? std::optional(static_cast<double>(*integer)) : std::nullopt;
}

std::optional<std::string> read_text(const Node& table, std::string_view key) {
  const Node* const node = of_kind(table, key, NodeKind::text);
  return node == nullptr ? std::nullopt : std::optional(node->text);
}

std::optional<canopen::Duration> read_duration(const Node& table, std::string_view key) {
  const Node* const node = of_kind(table, key, NodeKind::text);
  return node == nullptr ? std::nullopt : parse_duration(node->text);
}

std::optional<canopen::ObjectAddress> read_object(const Node& table, std::string_view key) {
  const Node* const node = of_kind(table, key, NodeKind::text);
  return node == nullptr ? std::nullopt : canopen::parse_object(node->text);
}

std::optional<canopen::DataType> read_type(const Node& table, std::string_view key) {
  const Node* const node = of_kind(table, key, NodeKind::text);
  return node == nullptr ? std::nullopt : canopen::parse_type(node->text);
}

std::vector<const Node*> read_texts(const Node& table, std::string_view key) {
  std::vector<const Node*> texts;
  if (const Node* const list = of_kind(table, key, NodeKind::list); list != nullptr) {
    for (const Node& item : list->items) {
      if (item.kind == NodeKind::text) {
        texts.push_back(&item);
      }
    }
  }
  return texts;
}

std::vector<std::int64_t> read_integers(const Node& table, std::string_view key) {
  std::vector<std::int64_t> integers;
  if (const Node* const list = of_kind(table, key, NodeKind::list); list != nullptr) {
    for (const Node& item : list->items) {
      if (item.kind == NodeKind::integer) {
        integers.push_back(item.integer);
      }
    }
  }
  return integers;
}

const Node* read_table(const Node& table, std::string_view key) {
  return of_kind(table, key, NodeKind::table);
}

std::vector<const Node*> read_tables(const Node& table, std::string_view key) {
  std::vector<const Node*> tables;
  if (const Node* const list = of_kind(table, key, NodeKind::list); list != nullptr) {
    for (const Node& item : list->items) {
      if (item.kind == NodeKind::table) {
        tables.push_back(&item);
      }
    }
  }
  return tables;
}

std::vector<std::pair<std::int64_t, const Entry*>> read_numbered(const Node& table, std::string_view key) {
  std::vector<std::pair<std::int64_t, const Entry*>> numbered;
  if (const Node* const node = of_kind(table, key, NodeKind::table); node != nullptr) {
    for (const Entry& entry : node->entries) {
      if (const auto number = parse_integer(entry.key); number.has_value()) {
        numbered.emplace_back(*number, &entry);
      }
    }
  }
  // Of two spellings of one number the one laid over the other comes last: entries keep their order.
  std::sort(numbered.begin(), numbered.end());
  return numbered;
}

Place place_of(const Node& table, std::string_view key) {
  const Node* const node = table.find(key);
  return node == nullptr ? table.place : node->place;
}

}  // namespace config
