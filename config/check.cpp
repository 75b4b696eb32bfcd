#include "config/check.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>
#include <vector>

#include "config/nearest.h"
#include "config/text.h"

namespace config {
namespace {

std::vector<std::string_view> parts_of(std::string_view choices) {
  std::vector<std::string_view> parts;
  while (!choices.empty()) {
    const auto bar = std::min(choices.find('|'), choices.size());
    parts.push_back(choices.substr(0, bar));
    choices.remove_prefix(std::min(bar + 1, choices.size()));
  }
  return parts;
}

void collect_names(const Section& section, std::vector<std::string_view>& names) {
  for (const Section* at = &section; at != nullptr; at = at->also) {
    for (const Key& key : at->keys) {
      names.push_back(key.name);
    }
  }
}

std::string quoted(std::string_view text) {
  std::string result = "\"";
  for (const char c : text.substr(0, 80)) {
    result += static_cast<unsigned char>(c) < 0x20 || c == 0x7F ? '?' : c;
  }
  return result + (text.size() > 80 ? "…\"" : "\"");
}

class Checker {
 public:
  Checker(std::string where, Report& report) : where_(std::move(where)), report_(report) {}

  void table(const Node& table, const Section& section, const std::string& path);

 private:
  void entry(const Entry& entry, const Section& section, const std::string& path);
  void value(const Node& node, const Key& key, const std::string& path);
  bool scalar(const Node& node, const Key& key, const std::string& path);
  void structure(const Node& node, const Key& key, const std::string& path);

  bool is(const Node& node, NodeKind kind, const std::string& path);
  void integer(const Node& node, const Key& key, const std::string& path);
  void number(const Node& node, const std::string& path);
  void duration(const Node& node, const Key& key, const std::string& path);
  void choice(const Node& node, const Key& key, const std::string& path);
  void notation(const Node& node, bool good, const std::string& path, std::string_view form);
  void text_notation(const Node& node, const Key& key, const std::string& path);
  void cob_id(const Node& node, const Key& key, const std::string& path);
  void unit(const Node& node, const Key& key, const std::string& path);
  void list(const Node& node, const Key& key, const std::string& path);
  void tables(const Node& node, const Key& key, const std::string& path);
  void named(const Node& node, const Key& key, const std::string& path);
  void numbered(const Node& node, const Key& key, const std::string& path);
  void fault(const Node& node, const std::string& path);
  void default_only(const Node& node, const Key& key, const std::string& path);

  void error(Place place, const std::string& text) {
    report_.error(place, where_.empty() ? text : where_ + ": " + text);
  }

  std::string where_;
  Report& report_;
};

bool Checker::is(const Node& node, NodeKind kind, const std::string& path) {
  if (node.kind == kind) {
    return true;
  }
  error(node.place, path + " must be " + std::string(name_of(kind)) + ", not " + std::string(name_of(node.kind)));
  return false;
}

void Checker::integer(const Node& node, const Key& key, const std::string& path) {
  if (is(node, NodeKind::integer, path) && (node.integer < key.min || node.integer > key.max)) {
    error(node.place, path + " " + std::to_string(node.integer) + " is out of range " + std::to_string(key.min) +
                          ".." + std::to_string(key.max));
  }
}

void Checker::number(const Node& node, const std::string& path) {
  if (node.kind != NodeKind::integer && node.kind != NodeKind::number) {
    is(node, NodeKind::number, path);
  } else if (node.kind == NodeKind::number && !std::isfinite(node.number)) {
    error(node.place, path + " must be a finite number");
  }
}

void Checker::duration(const Node& node, const Key& key, const std::string& path) {
  if (node.kind != NodeKind::text) {
    error(node.place, path + " must be a duration with its unit, such as \"500ms\", not " +
                          std::string(name_of(node.kind)));
    return;
  }
  const auto duration = parse_duration(node.text);
  if (!duration.has_value()) {
    error(node.place, path + " " + quoted(node.text) + " is no duration; write a number with us, ms, s, min or h, " +
                          "such as \"500ms\"");
  } else if (duration->count() < key.min || duration->count() > key.max) {
    error(node.place, path + " " + quoted(node.text) + " is out of range " + to_text(canopen::Duration(key.min)) +
                          ".." + to_text(canopen::Duration(key.max)));
  }
}

void Checker::choice(const Node& node, const Key& key, const std::string& path) {
  if (!is(node, NodeKind::text, path)) {
    return;
  }
  const auto choices = parts_of(key.choices);
  if (std::find(choices.begin(), choices.end(), node.text) == choices.end()) {
    error(node.place, path + " " + quoted(node.text) + " is not known; nearest is " +
                          quoted(nearest(node.text, choices)));
  }
}

void Checker::notation(const Node& node, bool good, const std::string& path, std::string_view form) {
  if (!good) {
    error(node.place, path + " " + quoted(node.text) + " must be " + std::string(form));
  }
}

void Checker::text_notation(const Node& node, const Key& key, const std::string& path) {
  if (!is(node, NodeKind::text, path)) {
    return;
  }
  switch (key.kind) {
    case KeyKind::name:
      return notation(node, is_name(node.text), path, "1 to 32 letters, digits, '_' or '-'");
    case KeyKind::object:
      return notation(node, canopen::parse_object(node.text).has_value(), path, "an object such as \"0x2021:02\"");
    case KeyKind::type:
      return notation(node, canopen::parse_type(node.text).has_value(), path,
                      "one of bool, u8, u16, u32, u64, i8, i16, i32, i64, f32, f64");
    default:
      return notation(node, is_plain_text(node.text), path, "at most 200 bytes without control characters");
  }
}

void Checker::cob_id(const Node& node, const Key& key, const std::string& path) {
  if (node.kind == NodeKind::text) {
    notation(node, parse_cob_id(node.text, 0).has_value(), path, "a number or \"$NODEID+0x180\"");
  } else {
    integer(node, key, path);
  }
}

void Checker::unit(const Node& node, const Key& key, const std::string& path) {
  if (node.kind == NodeKind::text) {
    notation(node, node.text == "none", path, "1..247 or \"none\"");
  } else {
    integer(node, key, path);
  }
}

void Checker::list(const Node& node, const Key& key, const std::string& path) {
  if (!is(node, NodeKind::list, path)) {
    return;
  }
  for (const Node& item : node.items) {
    switch (key.kind) {
      case KeyKind::choices:
        choice(item, key, path);
        break;
      case KeyKind::integers:
        integer(item, key, path);
        break;
      case KeyKind::mapping:
        if (is(item, NodeKind::text, path)) {
          notation(item, parse_mapped(item.text).has_value(), path, "an object and its type, such as \"0x2021:02 u16\"");
        }
        break;
      default:
        if (is(item, NodeKind::text, path)) {
          notation(item, is_plain_text(item.text), path, "at most 200 bytes without control characters");
        }
    }
  }
}

void Checker::tables(const Node& node, const Key& key, const std::string& path) {
  if (!is(node, NodeKind::list, path)) {
    return;
  }
  std::size_t number = 0;
  for (const Node& item : node.items) {
    ++number;
    if (!is(item, NodeKind::table, path)) {
      continue;
    }
    const Node* const name = item.find("name");
    const bool named = name != nullptr && name->kind == NodeKind::text && find_key(*key.section, "name") != nullptr;
    const std::string label = path + " " + (named ? quoted(name->text) : std::to_string(number));
    Checker(where_.empty() ? label : where_ + ": " + label, report_).table(item, *key.section, "");
  }
}

void Checker::named(const Node& node, const Key& key, const std::string& path) {
  if (!is(node, NodeKind::table, path)) {
    return;
  }
  for (const Entry& named : node.entries) {
    if (key.kind == KeyKind::signals && !is_signal_name(named.key)) {
      error(named.key_place, "the signal name " + quoted(named.key) +
                                 " must be lower case letters, digits and '_', beginning with a letter");
    } else if (key.kind == KeyKind::presets && !is_name(named.key)) {
      error(named.key_place, "the name " + quoted(named.key) + " must be 1 to 32 letters, digits, '_' or '-'");
    }
    const std::string below = path + "." + named.key.substr(0, 80);
    if (is(named.value, NodeKind::table, below)) {
      table(named.value, *key.section, below + ".");
    }
  }
}

void Checker::numbered(const Node& node, const Key& key, const std::string& path) {
  if (!is(node, NodeKind::table, path)) {
    return;
  }
  std::set<std::int64_t> seen;
  for (const Entry& numbered : node.entries) {
    const auto number = parse_integer(numbered.key);
    if (!number.has_value() || *number < key.min || *number > key.max) {
      error(numbered.key_place, path + " has the key " + quoted(numbered.key) + ", which is no number in " +
                                    std::to_string(key.min) + ".." + std::to_string(key.max));
    } else if (!seen.insert(*number).second) {
      error(numbered.key_place, path + " names the number " + quoted(numbered.key) + " twice");
    }
    const std::string below = path + "." + numbered.key.substr(0, 80);
    if (key.kind == KeyKind::faults && numbered.value.kind == NodeKind::table) {
      fault(numbered.value, below);
    } else if (is(numbered.value, NodeKind::text, below)) {
      notation(numbered.value, is_plain_text(numbered.value.text) && !numbered.value.text.empty(), below,
               "1 to 200 bytes without control characters");
    }
  }
}

void Checker::fault(const Node& node, const std::string& path) {
  static constexpr Key kKeys[] = {  // NOLINT(modernize-avoid-c-arrays): the span of a section
      {.name = "text", .kind = KeyKind::text, .required = true},
      {.name = "severity", .kind = KeyKind::choice, .choices = "fault|warning"}};
  static constexpr Section kSection{.title = "", .keys = kKeys};
  table(node, kSection, path + ".");
}

void Checker::default_only(const Node& node, const Key& key, const std::string& path) {
  const bool is_default =
      key.kind == KeyKind::duration ? parse_duration(node.text) == parse_duration(key.standard) : node.text == key.standard;
  if (!is_default) {
    error(node.place, path + " = " + quoted(node.text) + " is not supported by this version; only \"" +
                          std::string(key.standard) + "\" is");
  }
}

bool Checker::scalar(const Node& node, const Key& key, const std::string& path) {
  switch (key.kind) {
    case KeyKind::boolean:
      is(node, NodeKind::boolean, path);
      return true;
    case KeyKind::integer:
      integer(node, key, path);
      return true;
    case KeyKind::number:
      number(node, path);
      return true;
    case KeyKind::duration:
      duration(node, key, path);
      return true;
    case KeyKind::choice:
      choice(node, key, path);
      return true;
    case KeyKind::text:
    case KeyKind::name:
    case KeyKind::object:
    case KeyKind::type:
      text_notation(node, key, path);
      return true;
    case KeyKind::cob_id:
      cob_id(node, key, path);
      return true;
    case KeyKind::unit:
      unit(node, key, path);
      return true;
    default:
      return false;
  }
}

void Checker::structure(const Node& node, const Key& key, const std::string& path) {
  switch (key.kind) {
    case KeyKind::table:
      if (is(node, NodeKind::table, path)) {
        table(node, *key.section, path + ".");
      }
      break;
    case KeyKind::tables:
      tables(node, key, path);
      break;
    case KeyKind::signals:
    case KeyKind::presets:
      named(node, key, path);
      break;
    case KeyKind::numbered:
    case KeyKind::faults:
      numbered(node, key, path);
      break;
    default:
      list(node, key, path);
  }
}

void Checker::value(const Node& node, const Key& key, const std::string& path) {
  if (!scalar(node, key, path)) {
    structure(node, key, path);
  }
}

void Checker::entry(const Entry& entry, const Section& section, const std::string& path) {
  const Key* const key = find_key(section, entry.key);
  if (key == nullptr) {
    std::vector<std::string_view> names;
    collect_names(section, names);
    error(entry.key_place, "unknown key " + quoted(path + entry.key) + "; nearest is " +
                               quoted(path + std::string(nearest(entry.key, names))));
    return;
  }
  const std::string full = path + entry.key;
  if (key->support == Support::none) {
    const bool heads_table = entry.value.kind == NodeKind::table && path.empty() && where_.empty();
    error(entry.key_place, (heads_table ? "[" + full + "]" : full) + " is not supported by this version");
    return;
  }
  value(entry.value, *key, full);
  if (key->support == Support::default_only && entry.value.kind == NodeKind::text) {
    default_only(entry.value, *key, full);
  }
}

void Checker::table(const Node& table, const Section& section, const std::string& path) {
  for (const Entry& each : table.entries) {
    entry(each, section, path);
  }
  for (const Section* at = &section; at != nullptr; at = at->also) {
    for (const Key& key : at->keys) {
      if (key.required && table.find(key.name) == nullptr) {
        error(table.place, path + std::string(key.name) + " is missing");
      }
    }
  }
}

}  // namespace

void check(const Node& table, const Section& section, std::string_view where, Report& report) {
  Checker(std::string(where), report).table(table, section, "");
}

}  // namespace config
