#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "canopen/clock.h"
#include "canopen/object.h"
#include "config/document.h"

// Values out of a table that was checked against its section. What is missing, or was found wrong by that check, reads
// as nothing: the finding stands, and reading goes on to find the next mistake.

namespace config {

[[nodiscard]] std::optional<bool> read_boolean(const Node& table, std::string_view key);
[[nodiscard]] std::optional<std::int64_t> read_integer(const Node& table, std::string_view key);
[[nodiscard]] std::optional<double> read_number(const Node& table, std::string_view key);
[[nodiscard]] std::optional<std::string> read_text(const Node& table, std::string_view key);
[[nodiscard]] std::optional<canopen::Duration> read_duration(const Node& table, std::string_view key);
[[nodiscard]] std::optional<canopen::ObjectAddress> read_object(const Node& table, std::string_view key);
[[nodiscard]] std::optional<canopen::DataType> read_type(const Node& table, std::string_view key);
/// The items of a list that are strings.
[[nodiscard]] std::vector<const Node*> read_texts(const Node& table, std::string_view key);
/// The items of a list of integers.
[[nodiscard]] std::vector<std::int64_t> read_integers(const Node& table, std::string_view key);
/// A sub-table; null where there is none.
[[nodiscard]] const Node* read_table(const Node& table, std::string_view key);
/// The tables of a list of tables.
[[nodiscard]] std::vector<const Node*> read_tables(const Node& table, std::string_view key);
/// A table of number -> value, by number.
[[nodiscard]] std::vector<std::pair<std::int64_t, const Entry*>> read_numbered(const Node& table, std::string_view key);

/// An integer that fits T; nothing for any other.
template <class T>
[[nodiscard]] std::optional<T> read_as(const Node& table, std::string_view key) {
  const auto number = read_integer(table, key);
  return number.has_value() && std::in_range<T>(*number) ? std::optional<T>(static_cast<T>(*number)) : std::nullopt;
}

/// Where the value of a key stands; the table's own place where it has none.
[[nodiscard]] Place place_of(const Node& table, std::string_view key);

/// Overwrites `target` where there is a value.
template <class T>
void take(T& target, const std::optional<T>& value) {
  if (value.has_value()) {
    target = *value;
  }
}

}  // namespace config
