#include "bridges/alarms/alarm_json.h"

#include <boost/json/parse.hpp>
#include <boost/json/value.hpp>
#include <charconv>
#include <limits>
#include <utility>

#include "bridges/text/json_text.h"
#include "bridges/text/timestamp.h"

namespace alarms {
namespace {

namespace json = boost::json;

constexpr std::size_t kMaxLength = 64UL * 1024;
constexpr std::size_t kMaxErrors = 256;

std::string hex_text(std::uint64_t value, std::size_t digits) {
  constexpr std::string_view kDigits = "0123456789ABCDEF";
  std::string text(digits, '0');
  for (std::size_t i = digits; i > 0; --i, value >>= 4U) {
    text[i - 1] = kDigits[value & 0xFU];
  }
  return text;
}

std::string vendor_text(const std::array<std::uint8_t, 5>& vendor) {
  std::string text;
  for (const std::uint8_t byte : vendor) {
    text += hex_text(byte, 2);
  }
  return text;
}

std::string_view severity_text(config::Severity severity) {
  return severity == config::Severity::fault ? "fault" : "warning";
}

// A time that never was is null.
void append_time(text::ObjectText& object, std::string_view name, canopen::WallTime time) {
  if (time == canopen::WallTime{}) {
    object.null(name);
  } else {
    object.text(name, text::timestamp(time));
  }
}

void append_errors(std::string& out, const std::vector<AlarmError>& errors) {
  out += '[';
  bool first = true;
  for (const AlarmError& error : errors) {
    text::append_separator(out, first);
    text::ObjectText object(out);
    object.text("code", "0x" + hex_text(error.code, 4));
    object.text("text", error.text);
    append_time(object, "since", error.since);
    object.close();
  }
  out += ']';
}

// Readers of single members: they fail on a missing member too, but for the times.

template <class Integer>
bool read_hex(std::string_view text, Integer& value) {
  const auto end = std::from_chars(text.data(), text.data() + text.size(), value, 16);
  return end.ec == std::errc{} && end.ptr == text.data() + text.size();
}

std::optional<std::string_view> string_of(const json::object& object, json::string_view name) {
  const json::value* value = object.if_contains(name);
  const json::string* text = value != nullptr ? value->if_string() : nullptr;
  if (text == nullptr) {
    return std::nullopt;
  }
  return std::string_view(text->data(), text->size());
}

bool read_text(const json::object& object, json::string_view name, std::string& out) {
  const auto text = string_of(object, name);
  out = text.value_or("");
  return text.has_value();
}

bool read_bool(const json::object& object, json::string_view name, bool& out) {
  const json::value* value = object.if_contains(name);
  const bool* known = value != nullptr ? value->if_bool() : nullptr;
  out = known != nullptr && *known;
  return known != nullptr;
}

bool read_time(const json::object& object, json::string_view name, canopen::WallTime& out) {
  const json::value* value = object.if_contains(name);
  if (value == nullptr || value->is_null()) {
    out = {};
    return true;
  }
  const auto text = string_of(object, name);
  const auto time = text ? text::parse_timestamp(*text) : std::nullopt;
  out = time.value_or(canopen::WallTime{});
  return time.has_value();
}

// `0x0005`: as many digits as the number has.
template <class Integer>
bool read_code(const json::object& object, json::string_view name, Integer& out) {
  const auto text = string_of(object, name);
  return text && text->size() == 2 + 2 * sizeof(Integer) && text->starts_with("0x") && read_hex(text->substr(2), out);
}

bool read_vendor(const json::object& object, std::array<std::uint8_t, 5>& out) {
  const auto text = string_of(object, "vendor");
  if (!text || text->size() != 2 * out.size()) {
    return false;
  }
  for (std::size_t i = 0; i < out.size(); ++i) {
    if (!read_hex(text->substr(2 * i, 2), out[i])) {
      return false;
    }
  }
  return true;
}

bool read_severity(const json::object& object, config::Severity& out) {
  const auto text = string_of(object, "severity");
  out = text == "warning" ? config::Severity::warning : config::Severity::fault;
  return text == "warning" || text == "fault";
}

bool read_count(const json::object& object, std::uint32_t& out) {
  const json::value* value = object.if_contains("count");
  json::error_code failure;
  const auto number = value != nullptr ? value->to_number<std::uint32_t>(failure) : 0U;
  out = number;
  return value != nullptr && !failure;
}

bool read_errors(const json::object& object, Alarm& alarm) {
  const json::value* value = object.if_contains("errors");
  const json::array* list = value != nullptr ? value->if_array() : nullptr;
  if (list == nullptr || list->size() > kMaxErrors) {
    return false;
  }
  for (const json::value& item : *list) {
    const json::object* entry = item.if_object();
    AlarmError error;
    if (entry == nullptr || !read_code(*entry, "code", error.code) || !read_text(*entry, "text", error.text) ||
        !read_time(*entry, "since", error.since)) {
      return false;
    }
    error.severity = alarm.severity;
    if (error.code == alarm.code && error.text == alarm.text) {
      error.vendor = alarm.vendor;
    }
    alarm.errors.push_back(std::move(error));
  }
  return true;
}

}  // namespace

std::string alarm_json(const Alarm& alarm) {
  std::string out;
  text::ObjectText object(out);
  object.boolean("active", alarm.active);
  object.text("id", alarm.id);
  object.text("code", "0x" + hex_text(alarm.code, 4));
  object.text("text", alarm.text);
  object.text("severity", severity_text(alarm.severity));
  object.text("register", "0x" + hex_text(alarm.error_register, 2));
  object.text("vendor", vendor_text(alarm.vendor));
  append_time(object, "since", alarm.since);
  append_time(object, "ts", alarm.ts);
  if (!alarm.active) {
    append_time(object, "cleared", alarm.cleared);
  }
  object.integer("count", alarm.count);
  object.boolean("confirmed", alarm.confirmed);
  append_errors(object.key("errors"), alarm.errors);
  object.close();
  return out;
}

std::optional<Alarm> parse_alarm(std::string_view text) {
  if (text.empty() || text.size() > kMaxLength) {
    return std::nullopt;
  }
  json::error_code failure;
  const json::value value = json::parse(json::string_view(text.data(), text.size()), failure);
  const json::object* object = failure ? nullptr : value.if_object();
  if (object == nullptr) {
    return std::nullopt;
  }
  Alarm alarm;
  const bool read = read_bool(*object, "active", alarm.active) && read_text(*object, "id", alarm.id) &&
                    read_code(*object, "code", alarm.code) && read_text(*object, "text", alarm.text) &&
                    read_severity(*object, alarm.severity) && read_code(*object, "register", alarm.error_register) &&
                    read_vendor(*object, alarm.vendor) && read_time(*object, "since", alarm.since) &&
                    read_time(*object, "ts", alarm.ts) && read_time(*object, "cleared", alarm.cleared) &&
                    read_count(*object, alarm.count) && read_bool(*object, "confirmed", alarm.confirmed) &&
                    read_errors(*object, alarm);
  if (!read) {
    return std::nullopt;
  }
  return alarm;
}

}  // namespace alarms
