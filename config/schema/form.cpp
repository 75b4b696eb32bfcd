#include "config/schema/form.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <utility>

#include "config/schema/nearest.h"
#include "config/text.h"
#include "config/toml/document.h"

namespace config {
namespace {

/// A string that must have a notation; `form` says which, `example` how it looks.
template <class T, class Parse>
Form<T> notation(std::string type, std::string form, std::string_view example, Parse parse,
                 std::function<std::string(const T&)> show = {}) {
  return {.type = std::move(type),
          .read = [form = std::move(form), example, parse](const Node& node,
                                                           const Complaint& complain) -> std::optional<T> {
            if (!expect(node, NodeKind::text, complain, example)) {
              return std::nullopt;
            }
            std::optional<T> value = parse(node.text);
            if (!value.has_value()) {
              complain.value(node.place, in_quotes(node.text) + " must be " + form);
            }
            return value;
          },
          .show = std::move(show)};
}

auto text_that(bool (*good)(std::string_view)) {
  return [good](const std::string& text) { return good(text) ? std::optional(text) : std::nullopt; };
}

std::string as_it_is(const std::string& text) {
  return text;
}

/// `"a", "b" or "c"`
std::string all_of(const std::vector<std::string_view>& texts) {
  std::string all;
  for (std::size_t i = 0; i < texts.size(); ++i) {
    all += (i == 0 ? "" : i + 1 == texts.size() ? " or " : ", ") + in_quotes(texts[i]);
  }
  return all;
}

/// `1..9`; without an end that only the number of bits sets.
std::string range_of(std::int64_t min, std::int64_t max) {
  const bool open = max == std::numeric_limits<std::int64_t>::max();
  return open ? "from " + std::to_string(min) + " on" : std::to_string(min) + ".." + std::to_string(max);
}

}  // namespace

bool expect_list(const Node& node, const Complaint& complain) {
  if (node.kind == NodeKind::text) {
    complain.value(node.place, "must be a list, not a string; write [" + in_quotes(node.text) + "]");
    return false;
  }
  return expect(node, NodeKind::list, complain);
}

bool expect(const Node& node, NodeKind kind, const Complaint& complain, std::string_view example) {
  if (node.kind == kind) {
    return true;
  }
  complain.value(node.place, "must be " + std::string(name_of(kind)) +
                                 (example.empty() ? "" : " such as " + std::string(example)) + ", not " +
                                 std::string(name_of(node.kind)));
  return false;
}

Form<bool> boolean() {
  return {.type = "true or false",
          .read = [](const Node& node, const Complaint& complain) -> std::optional<bool> {
            return expect(node, NodeKind::boolean, complain) ? std::optional(node.boolean) : std::nullopt;
          },
          .show = [](bool value) { return std::string(value ? "true" : "false"); }};
}

Form<std::int64_t> integer(std::int64_t min, std::int64_t max, std::string_view unit, std::string_view example) {
  const std::string range = std::to_string(min) + ".." + std::to_string(max);
  return {.type = "integer " + range,
          .read = [=](const Node& node, const Complaint& complain) -> std::optional<std::int64_t> {
            const std::string in_unit = unit.empty() ? "" : " " + std::string(unit);
            const std::string such = example.empty() ? "" : std::string(example) + in_unit;
            if (!expect(node, NodeKind::integer, complain, such)) {
              return std::nullopt;
            }
            if (node.integer < min || node.integer > max) {
              complain.value(node.place,
                             std::to_string(node.integer) + " is out of range " + range_of(min, max) + in_unit);
              return std::nullopt;
            }
            return node.integer;
          },
          .show = [](std::int64_t value) { return std::to_string(value); }};
}

Form<std::int64_t> any_integer(std::int64_t min) {
  Form<std::int64_t> form = integer(min, std::numeric_limits<std::int64_t>::max());
  form.type = "integer";
  return form;
}

Form<double> number() {
  return {.type = "number",
          .read = [](const Node& node, const Complaint& complain) -> std::optional<double> {
            if (node.kind == NodeKind::integer) {
              return static_cast<double>(node.integer);
            }
            if (!expect(node, NodeKind::number, complain)) {
              return std::nullopt;
            }
            if (!std::isfinite(node.number)) {
              complain.value(node.place, "must be a finite number");
              return std::nullopt;
            }
            return node.number;
          },
          .show = [](double value) { return to_text(value); }};
}

Form<double> number(double min, double max) {
  const std::string range = to_text(min) + ".." + to_text(max);
  Form<double> form = number();
  form.type = "number " + range;
  form.read = [=, any = form.read](const Node& node, const Complaint& complain) -> std::optional<double> {
    const auto value = any(node, complain);
    if (value.has_value() && (*value < min || *value > max)) {
      complain.value(node.place, to_text(*value) + " is out of range " + range);
      return std::nullopt;
    }
    return value;
  };
  return form;
}

Form<std::string> text() {
  return notation<std::string>("string", "at most 200 bytes without control characters", "", text_that(is_plain_text),
                               as_it_is);
}

Form<std::string> filled_text() {
  return {.type = "string", .read = read_short_text, .show = as_it_is};
}

Form<std::string> name() {
  return notation<std::string>("name", "1 to 32 letters, digits, '_' or '-'", "", text_that(is_name), as_it_is);
}

Form<canopen::Duration> duration(DurationRule rule) {
  const std::string allowed = (rule.zero ? "0s, " : "") + to_text(rule.min) + ".." + to_text(rule.max);
  return {.type = "duration " + allowed,
          .read = [=](const Node& node, const Complaint& complain) -> std::optional<canopen::Duration> {
            if (node.kind != NodeKind::text) {
              complain.value(node.place, "must be a duration with its unit, such as \"500ms\", not " +
                                             std::string(name_of(node.kind)));
              return std::nullopt;
            }
            const auto value = parse_duration(node.text);
            const bool is_zero = value == canopen::Duration::zero();
            if (!value.has_value()) {
              complain.value(node.place, in_quotes(node.text) +
                                             " is no duration; write a number with us, ms, s, min or h, such as "
                                             "\"500ms\"");
            } else if ((*value < rule.min || *value > rule.max) && !(rule.zero && is_zero)) {
              complain.value(node.place, in_quotes(node.text) + " is out of range " + allowed +
                                             (is_zero ? std::string(rule.without) : ""));
            } else if (rule.whole_ms && !whole_milliseconds(*value)) {
              complain.value(node.place, in_quotes(node.text) + " must be whole milliseconds");
            } else {
              return value;
            }
            return std::nullopt;
          },
          .show = [](const canopen::Duration& value) { return to_text(value); }};
}

Form<canopen::ObjectAddress> object() {
  constexpr std::string_view kExample = "\"0x2021:02\"";
  return notation<canopen::ObjectAddress>("string", "an object such as " + std::string(kExample), kExample,
                                          parse_stated_object);
}

Form<canopen::DataType> data_type() {
  return notation<canopen::DataType>("string", "one of bool, u8, u16, u32, u64, i8, i16, i32, i64, f32, f64", "\"u16\"",
                                     canopen::parse_type);
}

Form<std::pair<canopen::ObjectAddress, canopen::DataType>> mapped_object() {
  constexpr std::string_view kExample = "\"0x2021:02 u16\"";
  return notation<std::pair<canopen::ObjectAddress, canopen::DataType>>(
      "string", "an object and its type, such as " + std::string(kExample), kExample, parse_mapped);
}

Form<CobId> cob_id() {
  constexpr std::int64_t kLast = 0x7FF;
  return {.type = "integer or string",
          .read = [](const Node& node, const Complaint& complain) -> std::optional<CobId> {
            if (node.kind != NodeKind::text) {
              const auto number = integer(1, kLast).read(node, complain);
              return number.has_value() ? std::optional(CobId{.base = *number}) : std::nullopt;
            }
            const auto stated = parse_cob_id(node.text);
            if (!stated.has_value()) {
              complain.value(node.place, in_quotes(node.text) + " must be a number or \"$NODEID+0x180\"");
            }
            return stated;
          },
          .show = {}};
}

Form<Unit> unit() {
  constexpr std::int64_t kLast = 247;
  return {.type = "integer 1..247 or `\"none\"`",
          .read = [](const Node& node, const Complaint& complain) -> std::optional<Unit> {
            if (node.kind != NodeKind::text) {
              const auto number = integer(1, kLast).read(node, complain);
              return number.has_value() ? std::optional(Unit{static_cast<std::uint8_t>(*number)}) : std::nullopt;
            }
            if (node.text != "none") {
              complain.value(node.place, in_quotes(node.text) + " must be 1..247 or \"none\"");
              return std::nullopt;
            }
            return Unit{};
          },
          .show = {}};
}

std::optional<std::string> read_short_text(const Node& node, const Complaint& complain) {
  if (!expect(node, NodeKind::text, complain)) {
    return std::nullopt;
  }
  if (!is_plain_text(node.text) || node.text.empty()) {
    complain.value(node.place, "must be 1 to 200 bytes without control characters");
    return std::nullopt;
  }
  return node.text;
}

Form<std::map<std::int64_t, std::string>> numbered_texts(std::int64_t min, std::int64_t max) {
  return numbered<std::string>("number = string", min, max, read_short_text);
}

bool check_numbers(const Node& node, std::int64_t min, std::int64_t max, const Complaint& complain) {
  if (!expect(node, NodeKind::table, complain, "{ 1 = \"…\" }")) {
    return false;
  }
  const bool any = min == std::numeric_limits<std::int64_t>::min();
  bool good = true;
  std::set<std::int64_t> seen;
  for (const Entry& entry : node.entries) {
    const auto number = parse_integer(entry.key);
    if (!number.has_value() || *number < min || *number > max) {
      good = false;
      complain.value(entry.key_place, "has the key " + in_quotes(entry.key) + ", which is no number" +
                                          (any ? "" : " " + range_of(min, max)));
    } else if (!seen.insert(*number).second) {
      // No reason to read nothing: layers may spell one number in two ways, and the upper one counts.
      complain.value(entry.key_place, "names the number " + in_quotes(entry.key) + " twice");
    }
  }
  return good;
}

Form<std::size_t> one_of(std::vector<std::string_view> texts) {
  std::string type;
  for (const std::string_view text : texts) {
    type += (type.empty() ? "`" : ", `") + std::string(text) + "`";
  }
  return {.type = std::move(type),
          .read = [texts](const Node& node, const Complaint& complain) -> std::optional<std::size_t> {
            if (!expect(node, NodeKind::text, complain)) {
              return std::nullopt;
            }
            const auto found = std::find(texts.begin(), texts.end(), node.text);
            if (found == texts.end()) {
              const auto near = nearest(node.text, texts);
              complain.value(node.place,
                             in_quotes(node.text) + " is not known; " +
                                 (near.empty() ? "it can be " + all_of(texts) : "nearest is " + in_quotes(near)));
              return std::nullopt;
            }
            return static_cast<std::size_t>(found - texts.begin());
          },
          .show = {}};
}

}  // namespace config
