#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "config/finding.h"

namespace config {

/// Where something stands in one of the files that make up a configuration.
struct Place {
  std::uint16_t file = 0;  ///< Position in Context's list of files.
  std::uint32_t line = 0;  ///< From 1; 0: the file as a whole.
  std::uint32_t column = 0;
};

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

}  // namespace config
