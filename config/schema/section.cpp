#include "config/schema/section.h"

#include <algorithm>

#include "config/schema/nearest.h"
#include "config/text.h"

namespace config {
namespace {

constexpr std::int64_t kLastPdo = 512;

bool is_pattern(std::string_view key) {
  return key.ends_with('N');
}

/// `tpdo12` for the key `tpdoN`.
bool is_numbered(std::string_view pattern, std::string_view name) {
  if (!is_pattern(pattern) || !name.starts_with(pattern.substr(0, pattern.size() - 1))) {
    return false;
  }
  const std::string_view digits = name.substr(pattern.size() - 1);
  const auto number = parse_integer(digits);
  return !digits.starts_with('0') && number.has_value() && *number >= 1 && *number <= kLastPdo;
}

void collect_names(const Section& section, std::vector<std::string_view>& names) {
  for (const Section* at = &section; at != nullptr; at = at->also()) {
    for (const Key& key : at->keys()) {
      if (!is_pattern(key.name)) {
        names.push_back(key.name);
      }
    }
  }
}

std::string_view nearest_key(std::string_view name, const Section& section) {
  std::vector<std::string_view> names;
  collect_names(section, names);
  return nearest(name, names);
}

/// The title of a table of this one that has such a key: `[[bus]]` for `bitrate`; empty where none has.
std::string_view home_of(std::string_view name, const Section& section) {
  for (const Key& key : section.keys()) {
    if (key.below != nullptr && key.below->find(name) != nullptr) {
      return key.below->title();
    }
  }
  return {};
}

/// What to write instead of a key that is not known.
std::string remedy_of(std::string name, const Section& section, const Complaint& complain) {
  constexpr std::size_t kFew = 8;
  std::transform(name.begin(), name.end(), name.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  if ((name.starts_with("tpdo") || name.starts_with("rpdo")) && section.find("tpdo1") != nullptr) {
    return "PDOs are " + name.substr(0, 4) + "1 to " + name.substr(0, 4) + std::to_string(kLastPdo);
  }
  if (const auto near = nearest_key(name, section); !near.empty()) {
    return "nearest is " + in_quotes(complain.at(near).path());
  }
  if (const auto home = home_of(name, section); !home.empty()) {
    return "it is a key of " + std::string(home);
  }
  std::vector<std::string_view> names;
  collect_names(section, names);
  if (names.size() > kFew) {
    return "no key that is known here is like it; CONFIGURATION.md lists them";
  }
  std::string all;
  for (const std::string_view each : names) {
    all += (all.empty() ? "" : ", ") + std::string(each);
  }
  return "known here: " + all;
}

void check_entry(const Entry& entry, const Section& section, const Complaint& complain) {
  const Key* const key = section.find(entry.key);
  const Complaint below = complain.at(entry.key);
  if (key == nullptr) {
    complain.tell(entry.key_place,
                  "unknown key " + in_quotes(below.path()) + "; " + remedy_of(entry.key, section, complain));
  } else if (!key->built) {
    const bool heads_table = entry.value.kind == NodeKind::table && complain.at_root();
    complain.tell(entry.key_place, (heads_table ? "[" + below.path() + "]" : below.path()) +
                                       " is not supported by this version; leave it out");
  } else {
    key->check(entry.value, below);
  }
}

/// A required key that is not there, nor what may stand for it, nor a misspelling of it, which has its own finding.
bool is_missing(const Node& table, const Key& key, const Section& section) {
  return table.find(key.name) == nullptr && table.find(key.unless) == nullptr &&
         std::none_of(table.entries.begin(), table.entries.end(), [&](const Entry& entry) {
           return section.find(entry.key) == nullptr && nearest_key(entry.key, section) == key.name;
         });
}

void render(const Section& section, std::vector<const Section*>& done, std::string& out) {
  if (std::find(done.begin(), done.end(), &section) != done.end()) {
    return;
  }
  done.push_back(&section);
  out += "### " + section.title() + "\n\n";
  if (section.also() != nullptr) {
    out += "Also the keys of \"" + section.also()->title() + "\".\n\n";
  }
  out += "| key | type | default | meaning |\n|---|---|---|---|\n";
  for (const Key& key : section.keys()) {
    out += "| `" + key.name + "` | " + key.type + " | " + (key.required ? "required" : key.standard) + " | " +
           key.meaning + (key.built ? "" : " *Not supported by this version.*") + " |\n";
  }
  out += "\n";
  for (const Key& key : section.keys()) {
    if (key.below != nullptr) {
      render(*key.below, done, out);
    }
  }
  if (section.also() != nullptr) {
    render(*section.also(), done, out);
  }
}

}  // namespace

const Key* Section::find(std::string_view name) const noexcept {
  for (const Section* at = this; at != nullptr; at = at->also_) {
    for (const Key& key : at->keys_) {
      if (is_pattern(key.name) ? is_numbered(key.name, name) : key.name == name) {
        return &key;
      }
    }
  }
  return nullptr;
}

void check_table(const Node& table, const Section& section, const Complaint& complain) {
  if (table.kind == NodeKind::list && !table.items.empty() && table.items[0].kind == NodeKind::table) {
    complain.value(table.place, "is one table; write [" + complain.heading() + "], with single brackets, once");
    return;
  }
  if (!expect(table, NodeKind::table, complain)) {
    return;
  }
  for (const Entry& entry : table.entries) {
    check_entry(entry, section, complain);
  }
  for (const Section* at = &section; at != nullptr; at = at->also()) {
    for (const Key& key : at->keys()) {
      if (key.required && is_missing(table, key, section)) {
        complain.at(key.name).value(
            table.place, key.type == "tables" ? "is missing; write at least one [[" + key.name + "]]" : "is missing");
      }
    }
  }
}

void check_tables(const Node& list, const Section& section, const Complaint& complain) {
  const std::string remedy = "; write [[" + complain.heading() + "]], with two brackets, for each of them";
  if (list.kind != NodeKind::list) {
    complain.value(list.place, list.kind == NodeKind::table
                                   ? "is a list" + remedy
                                   : "must be a list, not " + std::string(name_of(list.kind)) + remedy);
    return;
  }
  for (std::size_t i = 0; i < list.items.size(); ++i) {
    const Node& item = list.items[i];
    if (item.kind != NodeKind::table) {
      complain.value(item.place, "must be a list of tables, not of " + std::string(name_of(item.kind)) + remedy);
      continue;
    }
    const Node* const name = section.find("name") == nullptr ? nullptr : item.find("name");
    const bool named = name != nullptr && name->kind == NodeKind::text;
    check_table(item, section, complain.within(named ? in_quotes(name->text) : std::to_string(i + 1)));
  }
}

void check_named(const Node& table, const Section& section, bool (*good_name)(std::string_view), std::string_view rule,
                 const Complaint& complain) {
  if (!expect(table, NodeKind::table, complain)) {
    return;
  }
  for (const Entry& named : table.entries) {
    if (!good_name(named.key)) {
      complain.tell(named.key_place, "the name " + in_quotes(named.key) + " must be " + std::string(rule));
    }
    check_table(named.value, section, complain.at(named.key));
  }
}

std::string render_reference(const std::vector<const Section*>& sections) {
  std::string out;
  std::vector<const Section*> done;
  for (const Section* const section : sections) {
    render(*section, done, out);
  }
  return out;
}

}  // namespace config
