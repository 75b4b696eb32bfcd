#include "config/toml/document.h"

#include <algorithm>
#include <array>
#include <optional>
#include <tuple>
#include <utility>

// The only file that knows toml++: it costs seconds of compile time wherever it is included.
#include <toml++/toml.h>

namespace config {
namespace {

// A value nested deeper than this is no configuration; toml++ itself stops at 256.
constexpr int kMaxDepth = 32;

// toml++ 3.3 limits the depth of lists and inline tables but not of dotted keys: `a.a.a. …` some ten thousand times
// over runs its recursive destructors out of stack. A key ends with its line.
constexpr std::size_t kLongestLine = 4096;

/// Where the first line goes too far; nothing where none does.
std::optional<Place> too_long(std::string_view text, std::uint16_t file) {
  std::size_t start = 0;
  for (std::uint32_t line = 1; start < text.size(); ++line) {
    const std::size_t end = std::min(text.find('\n', start), text.size());
    if (end - start > kLongestLine) {
      return Place{file, line, kLongestLine + 1};
    }
    start = end + 1;
  }
  return std::nullopt;
}

Place place_of(const toml::source_region& region, std::uint16_t file) {
  return {file, static_cast<std::uint32_t>(region.begin.line), static_cast<std::uint32_t>(region.begin.column)};
}

struct Remedy {
  std::string_view sign;  ///< What the library says.
  std::string_view text;  ///< What then mostly helps.
};

constexpr std::string_view kQuote =
    "; durations, names, addresses and objects need straight quotation marks, true and false none";
constexpr std::string_view kOnce = "; a key, and the heading of a table, stand there once";
constexpr std::array<Remedy, 14> kRemedies{{
    {"control characters", "; is the closing quotation mark missing?"},
    {"integer: expected digit", kQuote},
    {"floating-point: expected", kQuote},
    {"value type", kQuote},
    {"expected '='", "; write KEY = VALUE, the key of letters, digits, '_' and '-'"},
    {"expected value", "; write KEY = VALUE"},
    {"a comment or whitespace", "; the value ends before that: decimals have a point, digits no blanks"},
    {"leading zero", "; write the number without them"},
    {"as array-of-tables", "; its [[…]] comes before the tables that belong to it"},
    {"cannot redefine", kOnce},
    {"whitespace or comments", "; a comment begins with #"},
    {"utf-8", "; save the file as UTF-8"},
    {"escape sequence", "; between single quotation marks a backslash is one"},
    {"inline table", "; what stands in { } stands in one line"},
}};

/// The library's description without its refrain, and with a remedy.
std::string in_our_words(std::string_view description) {
  constexpr std::string_view kRefrain = "Error while parsing ";
  if (description.starts_with(kRefrain)) {
    description.remove_prefix(kRefrain.size());
  }
  const auto* const remedy = std::find_if(kRemedies.begin(), kRemedies.end(), [&](const Remedy& each) {
    return description.find(each.sign) != std::string_view::npos;
  });
  return "not TOML: " + std::string(description) + std::string(remedy == kRemedies.end() ? "" : remedy->text);
}

bool before(const Entry& a, const Entry& b) {
  return std::tie(a.key_place.line, a.key_place.column, a.key) < std::tie(b.key_place.line, b.key_place.column, b.key);
}

Node convert(const toml::node& from, std::uint16_t file, int depth);

void convert_list(const toml::array& from, Node& node, int depth) {
  node.kind = NodeKind::list;
  node.items.reserve(from.size());
  for (const toml::node& item : from) {
    node.items.push_back(convert(item, node.place.file, depth + 1));
  }
}

void convert_table(const toml::table& from, Node& node, int depth) {
  node.kind = NodeKind::table;
  node.entries.reserve(from.size());
  for (const auto& [key, value] : from) {
    node.entries.push_back({.key = std::string(key.str()),
                            .key_place = place_of(key.source(), node.place.file),
                            .value = convert(value, node.place.file, depth + 1)});
  }
  std::sort(node.entries.begin(), node.entries.end(), before);
}

Node convert(const toml::node& from, std::uint16_t file, int depth) {
  Node node;
  node.kind = NodeKind::other;
  node.place = place_of(from.source(), file);
  if (depth > kMaxDepth) {
    return node;
  }
  if (const auto* table = from.as_table(); table != nullptr) {
    convert_table(*table, node, depth);
  } else if (const auto* list = from.as_array(); list != nullptr) {
    convert_list(*list, node, depth);
  } else if (const auto* text = from.as_string(); text != nullptr) {
    node.kind = NodeKind::text;
    node.text = text->get();
  } else if (const auto* integer = from.as_integer(); integer != nullptr) {
    node.kind = NodeKind::integer;
    node.integer = integer->get();
  } else if (const auto* number = from.as_floating_point(); number != nullptr) {
    node.kind = NodeKind::number;
    node.number = number->get();
  } else if (const auto* boolean = from.as_boolean(); boolean != nullptr) {
    node.kind = NodeKind::boolean;
    node.boolean = boolean->get();
  }
  return node;
}

}  // namespace

std::string_view name_of(NodeKind kind) noexcept {
  constexpr std::array<std::string_view, 7> kNames{"true or false",
                                                   "an integer",
                                                   "a number",
                                                   "a string",
                                                   "a list",
                                                   "a table",
                                                   "a date, a time or a value nested too deeply"};
  return kNames.at(static_cast<std::size_t>(kind));
}

const Node* Node::find(std::string_view key) const noexcept {
  const auto found = std::find_if(entries.begin(), entries.end(), [key](const Entry& e) { return e.key == key; });
  return found == entries.end() ? nullptr : &found->value;
}

Node* Node::find(std::string_view key) noexcept {
  Entry* const found = find_entry(key);
  return found == nullptr ? nullptr : &found->value;
}

Entry* Node::find_entry(std::string_view key) noexcept {
  const auto found = std::find_if(entries.begin(), entries.end(), [key](const Entry& e) { return e.key == key; });
  return found == entries.end() ? nullptr : &*found;
}

std::variant<Node, ParseFailure> parse_toml(std::string_view text, std::uint16_t file) {
  if (const auto place = too_long(text, file); place.has_value()) {
    return ParseFailure{*place, "a line of more than " + std::to_string(kLongestLine) +
                                    " bytes; give what stands in { } a [heading] and lines of its own"};
  }
  // The packaged library is built with exceptions; they end here.
  try {
    return convert(toml::parse(text), file, 0);
  } catch (const toml::parse_error& error) {
    return ParseFailure{place_of(error.source(), file), in_our_words(error.description())};
  }
}

}  // namespace config
