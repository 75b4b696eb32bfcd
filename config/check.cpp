#include "config/check.h"

#include <array>
#include <set>
#include <utility>
#include <vector>

#include "config/check_value.h"
#include "config/nearest.h"
#include "config/text.h"

namespace config {
namespace {

void collect_names(const Section& section, std::vector<std::string_view>& names) {
  for (const Section* at = &section; at != nullptr; at = at->also) {
    for (const Key& key : at->keys) {
      names.push_back(key.name);
    }
  }
}

class Checker {
 public:
  Checker(std::string where, Report& report) : complain_(std::move(where), report) {}

  void table(const Node& table, const Section& section, const std::string& path);

 private:
  void entry(const Entry& entry, const Section& section, const std::string& path);
  void value(const Node& node, const Key& key, const std::string& path);
  void structure(const Node& node, const Key& key, const std::string& path);
  void tables(const Node& node, const Key& key, const std::string& path);
  void named(const Node& node, const Key& key, const std::string& path);
  void numbered(const Node& node, const Key& key, const std::string& path);
  void fault(const Node& node, const std::string& path);

  Complaint complain_;
};

void Checker::tables(const Node& node, const Key& key, const std::string& path) {
  if (!expect(node, NodeKind::list, path, complain_)) {
    return;
  }
  std::size_t number = 0;
  for (const Node& item : node.items) {
    ++number;
    if (!expect(item, NodeKind::table, path, complain_)) {
      continue;
    }
    const Node* const name = item.find("name");
    const bool named = name != nullptr && name->kind == NodeKind::text && find_key(*key.section, "name") != nullptr;
    const std::string label = path + " " + (named ? in_quotes(name->text) : std::to_string(number));
    Checker(complain_.where().empty() ? label : complain_.where() + ": " + label, complain_.report())
        .table(item, *key.section, "");
  }
}

void Checker::named(const Node& node, const Key& key, const std::string& path) {
  if (!expect(node, NodeKind::table, path, complain_)) {
    return;
  }
  for (const Entry& named : node.entries) {
    if (key.kind == KeyKind::signals && !is_signal_name(named.key)) {
      complain_(named.key_place, "the signal name " + in_quotes(named.key) +
                                     " must be lower case letters, digits and '_', beginning with a letter");
    } else if (key.kind == KeyKind::presets && !is_name(named.key)) {
      complain_(named.key_place, "the name " + in_quotes(named.key) + " must be 1 to 32 letters, digits, '_' or '-'");
    }
    const std::string below = path + "." + named.key.substr(0, 80);
    if (expect(named.value, NodeKind::table, below, complain_)) {
      table(named.value, *key.section, below + ".");
    }
  }
}

void Checker::numbered(const Node& node, const Key& key, const std::string& path) {
  if (!expect(node, NodeKind::table, path, complain_)) {
    return;
  }
  std::set<std::int64_t> seen;
  for (const Entry& numbered : node.entries) {
    const auto number = parse_integer(numbered.key);
    if (!number.has_value() || *number < key.min || *number > key.max) {
      complain_(numbered.key_place, path + " has the key " + in_quotes(numbered.key) + ", which is no number in " +
                                        std::to_string(key.min) + ".." + std::to_string(key.max));
    } else if (!seen.insert(*number).second) {
      complain_(numbered.key_place, path + " names the number " + in_quotes(numbered.key) + " twice");
    }
    const std::string below = path + "." + numbered.key.substr(0, 80);
    if (key.kind == KeyKind::faults && numbered.value.kind == NodeKind::table) {
      fault(numbered.value, below);
    } else if (expect(numbered.value, NodeKind::text, below, complain_)) {
      if (!is_plain_text(numbered.value.text) || numbered.value.text.empty()) {
        complain_(numbered.value.place, below + " must be 1 to 200 bytes without control characters");
      }
    }
  }
}

void Checker::fault(const Node& node, const std::string& path) {
  static constexpr std::array kKeys{Key{.name = "text", .kind = KeyKind::text, .required = true},
                                    Key{.name = "severity", .kind = KeyKind::choice, .choices = "fault|warning"}};
  static constexpr Section kSection{.title = "", .keys = kKeys};
  table(node, kSection, path + ".");
}

void Checker::structure(const Node& node, const Key& key, const std::string& path) {
  switch (key.kind) {
    case KeyKind::table:
      if (expect(node, NodeKind::table, path, complain_)) {
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
      check_list(node, key, path, complain_);
  }
}

void Checker::value(const Node& node, const Key& key, const std::string& path) {
  if (!check_scalar(node, key, path, complain_)) {
    structure(node, key, path);
  }
}

void Checker::entry(const Entry& entry, const Section& section, const std::string& path) {
  const Key* const key = find_key(section, entry.key);
  if (key == nullptr) {
    std::vector<std::string_view> names;
    collect_names(section, names);
    complain_(entry.key_place, "unknown key " + in_quotes(path + entry.key) + "; nearest is " +
                                   in_quotes(path + std::string(nearest(entry.key, names))));
    return;
  }
  const std::string full = path + entry.key;
  if (key->support == Support::none) {
    const bool heads_table = entry.value.kind == NodeKind::table && path.empty() && complain_.where().empty();
    complain_(entry.key_place, (heads_table ? "[" + full + "]" : full) + " is not supported by this version");
    return;
  }
  value(entry.value, *key, full);
  if (key->support == Support::default_only && entry.value.kind == NodeKind::text) {
    check_default_only(entry.value, *key, full, complain_);
  }
}

void Checker::table(const Node& table, const Section& section, const std::string& path) {
  for (const Entry& each : table.entries) {
    entry(each, section, path);
  }
  for (const Section* at = &section; at != nullptr; at = at->also) {
    for (const Key& key : at->keys) {
      if (key.required && table.find(key.name) == nullptr) {
        complain_(table.place, path + std::string(key.name) + " is missing");
      }
    }
  }
}

}  // namespace

void check(const Node& table, const Section& section, std::string_view where, Report& report) {
  Checker(std::string(where), report).table(table, section, "");
}

}  // namespace config
