#include "config/schema.h"

#include <algorithm>
#include <vector>

#include "config/text.h"

namespace config {
namespace {

/// `tpdo12` for the key `tpdoN`.
bool is_numbered(std::string_view pattern, std::string_view name) {
  if (!pattern.ends_with('N') || !name.starts_with(pattern.substr(0, pattern.size() - 1))) {
    return false;
  }
  const std::string_view digits = name.substr(pattern.size() - 1);
  const auto number = parse_integer(digits);
  return !digits.starts_with('0') && number.has_value() && *number >= 1 && *number <= 512;
}

std::string range_of(const Key& key) {
  return key.kind == KeyKind::duration
             ? to_text(canopen::Duration(key.min)) + ".." + to_text(canopen::Duration(key.max))
             : std::to_string(key.min) + ".." + std::to_string(key.max);
}

std::string list_of(std::string_view choices) {
  std::string text;
  for (const char c : choices) {
    text += c == '|' ? std::string("`, `") : std::string(1, c);
  }
  return "`" + text + "`";
}

/// Ranges that end at the ends of an integer say nothing to people.
bool has_range(const Key& key) {
  constexpr std::int64_t kFar = std::int64_t{1} << 62;
  return key.max < kFar && key.max != key.min;
}

std::string type_of(const Key& key) {
  switch (key.kind) {
    case KeyKind::boolean:
      return "true or false";
    case KeyKind::integer:
      return has_range(key) ? "integer " + range_of(key) : "integer";
    case KeyKind::number:
      return "number";
    case KeyKind::text:
    case KeyKind::type:
    case KeyKind::object:
      return "string";
    case KeyKind::name:
      return "name";
    case KeyKind::duration:
      return "duration " + range_of(key);
    case KeyKind::choice:
      return list_of(key.choices);
    case KeyKind::cob_id:
      return "integer or string";
    case KeyKind::unit:
      return "integer " + range_of(key) + " or `\"none\"`";
    case KeyKind::texts:
    case KeyKind::mapping:
      return "list of strings";
    case KeyKind::choices:
      return "list of " + list_of(key.choices);
    case KeyKind::integers:
      return "list of integers";
    case KeyKind::table:
      return "table";
    case KeyKind::tables:
      return "tables";
    case KeyKind::signals:
    case KeyKind::presets:
      return "tables by name";
    case KeyKind::numbered:
      return "number = string";
    case KeyKind::faults:
      return "number = string or { text, severity }";
  }
  return "";
}

std::string standard_of(const Key& key) {
  if (key.required) {
    return "required";
  }
  return key.standard.empty() ? "" : std::string(key.standard);
}

std::string meaning_of(const Key& key) {
  switch (key.support) {
    case Support::none:
      return std::string(key.meaning) + " *Not supported by this version.*";
    case Support::default_only:
      return std::string(key.meaning) + " *Only the default in this version.*";
    case Support::built:
      break;
  }
  return std::string(key.meaning);
}

void render_section(const Section& section, std::vector<const Section*>& done, std::string& out) {
  if (std::find(done.begin(), done.end(), &section) != done.end()) {
    return;
  }
  done.push_back(&section);
  out += "### " + std::string(section.title) + "\n\n";
  if (section.also != nullptr) {
    out += "Also the keys of \"" + std::string(section.also->title) + "\".\n\n";
  }
  out += "| key | type | default | meaning |\n|---|---|---|---|\n";
  for (const Key& key : section.keys) {
    out += "| `" + std::string(key.name) + "` | " + type_of(key) + " | " + standard_of(key) + " | " + meaning_of(key) +
           " |\n";
  }
  out += "\n";
  for (const Key& key : section.keys) {
    if (key.section != nullptr) {
      render_section(*key.section, done, out);
    }
  }
  if (section.also != nullptr) {
    render_section(*section.also, done, out);
  }
}

}  // namespace

const Key* find_key(const Section& section, std::string_view name) noexcept {
  for (const Section* at = &section; at != nullptr; at = at->also) {
    for (const Key& key : at->keys) {
      if (key.name == name || is_numbered(key.name, name)) {
        return &key;
      }
    }
  }
  return nullptr;
}

std::string render_reference() {
  std::string out;
  std::vector<const Section*> done;
  render_section(kSiteSection, done, out);
  render_section(kProfileSection, done, out);
  return out;
}

}  // namespace config
