#include "config/check_value.h"

#include <algorithm>
#include <cmath>
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

class ValueCheck {
 public:
  ValueCheck(const std::string& path, const Complaint& complain) : path_(path), complain_(complain) {}

  bool scalar(const Node& node, const Key& key);
  void list(const Node& node, const Key& key);

 private:
  bool is(const Node& node, NodeKind kind) { return expect(node, kind, path_, complain_); }
  void integer(const Node& node, const Key& key);
  void number(const Node& node);
  void duration(const Node& node, const Key& key);
  void choice(const Node& node, const Key& key);
  void notation(const Node& node, bool good, std::string_view form);
  void text_notation(const Node& node, const Key& key);
  void cob_id(const Node& node, const Key& key);
  void unit(const Node& node, const Key& key);

  const std::string& path_;
  const Complaint& complain_;
};

void ValueCheck::integer(const Node& node, const Key& key) {
  if (is(node, NodeKind::integer) && (node.integer < key.min || node.integer > key.max)) {
    complain_(node.place, path_ + " " + std::to_string(node.integer) + " is out of range " + std::to_string(key.min) +
                              ".." + std::to_string(key.max));
  }
}

void ValueCheck::number(const Node& node) {
  if (node.kind != NodeKind::integer && node.kind != NodeKind::number) {
    is(node, NodeKind::number);
  } else if (node.kind == NodeKind::number && !std::isfinite(node.number)) {
    complain_(node.place, path_ + " must be a finite number");
  }
}

void ValueCheck::duration(const Node& node, const Key& key) {
  if (node.kind != NodeKind::text) {
    complain_(node.place,
              path_ + " must be a duration with its unit, such as \"500ms\", not " + std::string(name_of(node.kind)));
    return;
  }
  const auto duration = parse_duration(node.text);
  if (!duration.has_value()) {
    complain_(node.place, path_ + " " + in_quotes(node.text) +
                              " is no duration; write a number with us, ms, s, min or h, " + "such as \"500ms\"");
  } else if (duration->count() < key.min || duration->count() > key.max) {
    complain_(node.place, path_ + " " + in_quotes(node.text) + " is out of range " +
                              to_text(canopen::Duration(key.min)) + ".." + to_text(canopen::Duration(key.max)));
  }
}

void ValueCheck::choice(const Node& node, const Key& key) {
  if (!is(node, NodeKind::text)) {
    return;
  }
  const auto choices = parts_of(key.choices);
  if (std::find(choices.begin(), choices.end(), node.text) == choices.end()) {
    complain_(node.place, path_ + " " + in_quotes(node.text) + " is not known; nearest is " +
                              in_quotes(nearest(node.text, choices)));
  }
}

void ValueCheck::notation(const Node& node, bool good, std::string_view form) {
  if (!good) {
    complain_(node.place, path_ + " " + in_quotes(node.text) + " must be " + std::string(form));
  }
}

void ValueCheck::text_notation(const Node& node, const Key& key) {
  if (!is(node, NodeKind::text)) {
    return;
  }
  switch (key.kind) {
    case KeyKind::name:
      return notation(node, is_name(node.text), "1 to 32 letters, digits, '_' or '-'");
    case KeyKind::object:
      return notation(node, canopen::parse_object(node.text).has_value(), "an object such as \"0x2021:02\"");
    case KeyKind::type:
      return notation(node, canopen::parse_type(node.text).has_value(),
                      "one of bool, u8, u16, u32, u64, i8, i16, i32, i64, f32, f64");
    default:
      return notation(node, is_plain_text(node.text), "at most 200 bytes without control characters");
  }
}

void ValueCheck::cob_id(const Node& node, const Key& key) {
  if (node.kind == NodeKind::text) {
    notation(node, parse_cob_id(node.text, 0).has_value(), "a number or \"$NODEID+0x180\"");
  } else {
    integer(node, key);
  }
}

void ValueCheck::unit(const Node& node, const Key& key) {
  if (node.kind == NodeKind::text) {
    notation(node, node.text == "none", "1..247 or \"none\"");
  } else {
    integer(node, key);
  }
}

void ValueCheck::list(const Node& node, const Key& key) {
  if (!is(node, NodeKind::list)) {
    return;
  }
  for (const Node& item : node.items) {
    switch (key.kind) {
      case KeyKind::choices:
        choice(item, key);
        break;
      case KeyKind::integers:
        integer(item, key);
        break;
      case KeyKind::mapping:
        if (is(item, NodeKind::text)) {
          notation(item, parse_mapped(item.text).has_value(), "an object and its type, such as \"0x2021:02 u16\"");
        }
        break;
      default:
        if (is(item, NodeKind::text)) {
          notation(item, is_plain_text(item.text), "at most 200 bytes without control characters");
        }
    }
  }
}

bool ValueCheck::scalar(const Node& node, const Key& key) {
  switch (key.kind) {
    case KeyKind::boolean:
      is(node, NodeKind::boolean);
      return true;
    case KeyKind::integer:
      integer(node, key);
      return true;
    case KeyKind::number:
      number(node);
      return true;
    case KeyKind::duration:
      duration(node, key);
      return true;
    case KeyKind::choice:
      choice(node, key);
      return true;
    case KeyKind::text:
    case KeyKind::name:
    case KeyKind::object:
    case KeyKind::type:
      text_notation(node, key);
      return true;
    case KeyKind::cob_id:
      cob_id(node, key);
      return true;
    case KeyKind::unit:
      unit(node, key);
      return true;
    default:
      return false;
  }
}

}  // namespace

void Complaint::operator()(Place place, const std::string& text) const {
  report_.error(place, where_.empty() ? text : where_ + ": " + text);
}

std::string in_quotes(std::string_view text) {
  constexpr std::size_t kLongest = 80;
  return "\"" + std::string(text.substr(0, kLongest)) + (text.size() > kLongest ? "…\"" : "\"");
}

bool expect(const Node& node, NodeKind kind, const std::string& path, const Complaint& complain) {
  if (node.kind == kind) {
    return true;
  }
  complain(node.place, path + " must be " + std::string(name_of(kind)) + ", not " + std::string(name_of(node.kind)));
  return false;
}

bool check_scalar(const Node& node, const Key& key, const std::string& path, const Complaint& complain) {
  return ValueCheck(path, complain).scalar(node, key);
}

void check_list(const Node& node, const Key& key, const std::string& path, const Complaint& complain) {
  ValueCheck(path, complain).list(node, key);
}

void check_default_only(const Node& node, const Key& key, const std::string& path, const Complaint& complain) {
  const bool is_default = key.kind == KeyKind::duration ? parse_duration(node.text) == parse_duration(key.standard)
                                                        : node.text == key.standard;
  if (!is_default) {
    complain(node.place, path + " = " + in_quotes(node.text) + " is not supported by this version; only \"" +
                             std::string(key.standard) + "\" is");
  }
}

}  // namespace config
