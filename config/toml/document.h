#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "config/toml/report.h"

namespace config {

enum class NodeKind : std::uint8_t { boolean, integer, number, text, list, table, other };
/// `a string`, `a table`, … for findings.
[[nodiscard]] std::string_view name_of(NodeKind kind) noexcept;

struct Entry;

/// One value of a TOML text. Tables keep the order of the text, and every value its place, so that files laid over each
/// other still tell which of them a value came from.
struct Node {
  NodeKind kind = NodeKind::table;
  Place place;
  bool boolean = false;
  std::int64_t integer = 0;
  double number = 0.0;
  std::string text;
  std::vector<Node> items;     ///< Of a list.
  std::vector<Entry> entries;  ///< Of a table; no key twice.

  /// The value of a key; null where there is none, or this is no table.
  [[nodiscard]] const Node* find(std::string_view key) const noexcept;
  [[nodiscard]] Node* find(std::string_view key) noexcept;
  [[nodiscard]] Entry* find_entry(std::string_view key) noexcept;
};

struct Entry {
  std::string key;
  Place key_place;
  Node value;
};

/// What is wrong with a text that is not TOML.
struct ParseFailure {
  Place place;
  std::string text;
};

/// The root table, or the one thing that keeps the text from being TOML. `file` goes into the places.
[[nodiscard]] std::variant<Node, ParseFailure> parse_toml(std::string_view text, std::uint16_t file);

// Single values out of a table, for those who put tables together. What is missing or of another kind reads as nothing:
// its finding is the business of the schema.

[[nodiscard]] std::optional<std::string> read_text(const Node& table, std::string_view key);
/// The items of a list that are strings.
[[nodiscard]] std::vector<const Node*> read_texts(const Node& table, std::string_view key);
/// A sub-table; null where there is none.
[[nodiscard]] const Node* read_table(const Node& table, std::string_view key);
/// The tables of a list of tables.
[[nodiscard]] std::vector<const Node*> read_tables(const Node& table, std::string_view key);
/// A table of number -> value, by number; of two spellings of one number the one laid over the other comes last.
[[nodiscard]] std::vector<std::pair<std::int64_t, const Entry*>> read_numbered(const Node& table);

/// Where the value of a key stands; the table's own place where it has none.
[[nodiscard]] Place place_of(const Node& table, std::string_view key);
/// The one of two that stands in the site's own file, where exactly one does; else the first.
[[nodiscard]] Place in_the_site(Place first, Place second) noexcept;

}  // namespace config
