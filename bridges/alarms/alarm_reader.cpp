#include "bridges/alarms/alarm_reader.h"

#include <array>
#include <charconv>
#include <cstdint>
#include <optional>
#include <string_view>
#include <utility>

#include "bridges/text/timestamp.h"

namespace alarms {
namespace {

namespace json = boost::json;

// More than a drive keeps at once.
constexpr std::size_t kMaxErrors = 256;

template <class Integer>
bool read_hex(std::string_view text, Integer& value) {
  const auto end = std::from_chars(text.data(), text.data() + text.size(), value, 16);
  return end.ec == std::errc{} && end.ptr == text.data() + text.size();
}

/// Reads the members of one object; remembers the first that is not as it should be.
class Members {
 public:
  explicit Members(const json::object& object) : object_(object) {}

  void read(json::string_view name, bool& out) {
    const json::value* value = find(name);
    const bool* known = value != nullptr ? value->if_bool() : nullptr;
    expect(known != nullptr, name, "true or false");
    out = known != nullptr && *known;
  }
  void read(json::string_view name, std::string& out) {
    const auto text = string_of(name);
    expect(text.has_value(), name, "a text");
    out = text.value_or("");
  }
  /// A member that may be missing.
  void read_optional(json::string_view name, std::string& out) {
    if (find(name) != nullptr) {
      read(name, out);
    }
  }
  void read_count(json::string_view name, std::uint32_t& out) {
    const json::value* value = find(name);
    json::error_code failure;
    out = value != nullptr && value->is_number() ? value->to_number<std::uint32_t>(failure) : 0U;
    expect(value != nullptr && value->is_number() && !failure, name, "a number from 0 to 4294967295");
  }
  // null: it never was.
  void read_time(json::string_view name, canopen::WallTime& out) {
    const json::value* value = find(name);
    const auto text = string_of(name);
    const auto time = text ? text::parse_timestamp(*text) : std::nullopt;
    expect(time.has_value() || (value != nullptr && value->is_null()), name, "a time or null");
    out = time.value_or(canopen::WallTime{});
  }
  // `0x0005`: as many digits as the number has.
  template <class Integer>
  void read_code(json::string_view name, Integer& out) {
    const auto text = string_of(name);
    expect(text && text->size() == 2 + 2 * sizeof(Integer) && text->starts_with("0x") && read_hex(text->substr(2), out),
           name, sizeof(Integer) == 2 ? "0x and four hexadecimal digits" : "0x and two hexadecimal digits");
  }
  void read_vendor(std::array<std::uint8_t, 5>& out) {
    const auto text = string_of("vendor");
    bool good = text && text->size() == 2 * out.size();
    for (std::size_t i = 0; good && i < out.size(); ++i) {
      good = read_hex(text->substr(2 * i, 2), out[i]);
    }
    expect(good, "vendor", "ten hexadecimal digits");
  }
  void read_severity(config::Severity& out) {
    const auto text = string_of("severity");
    expect(text == "fault" || text == "warning", "severity", "fault or warning");
    out = text == "warning" ? config::Severity::warning : config::Severity::fault;
  }
  [[nodiscard]] const json::array* list(json::string_view name) {
    const json::value* value = find(name);
    const json::array* list = value != nullptr ? value->if_array() : nullptr;
    expect(list != nullptr, name, "a list");
    return list;
  }
  void expect(bool good, std::string_view name, std::string_view what) {
    if (!good && wrong_.empty()) {
      wrong_ = "\"" + std::string(name) + "\" is not " + std::string(what);
    }
  }
  [[nodiscard]] const std::string& wrong() const noexcept { return wrong_; }

 private:
  [[nodiscard]] const json::value* find(json::string_view name) const { return object_.if_contains(name); }
  [[nodiscard]] std::optional<std::string_view> string_of(json::string_view name) const {
    const json::value* value = find(name);
    const json::string* text = value != nullptr ? value->if_string() : nullptr;
    return text != nullptr ? std::optional(std::string_view(text->data(), text->size())) : std::nullopt;
  }

  const json::object& object_;
  std::string wrong_;
};

void read_errors(Members& members, std::vector<AlarmError>& errors) {
  const json::array* list = members.list("errors");
  if (list == nullptr) {
    return;
  }
  members.expect(list->size() <= kMaxErrors, "errors", "so short as it should be");
  for (const json::value& item : *list) {
    if (!members.wrong().empty()) {
      return;
    }
    const json::object* object = item.if_object();
    members.expect(object != nullptr, "errors", "a list of objects");
    if (object == nullptr) {
      return;
    }
    Members of_error(*object);
    AlarmError error;
    of_error.read_code("code", error.code);
    of_error.read_vendor(error.vendor);
    of_error.read_severity(error.severity);
    of_error.read("text", error.text);
    of_error.read_time("since", error.since);
    members.expect(of_error.wrong().empty(), "errors", "in order: " + of_error.wrong());
    errors.push_back(std::move(error));
  }
}

}  // namespace

ReadAlarm read_alarm(const json::value& value) {
  const json::object* object = value.if_object();
  if (object == nullptr) {
    return {{}, "it is no object"};
  }
  Members members(*object);
  Alarm alarm;
  alarm.known = true;
  members.read("active", alarm.active);
  members.read("id", alarm.id);
  members.read_code("code", alarm.code);
  members.read("reason", alarm.reason);
  members.read("text", alarm.text);
  members.read_severity(alarm.severity);
  members.read_code("register", alarm.error_register);
  members.read_vendor(alarm.vendor);
  members.read_time("since", alarm.since);
  members.read_time("ts", alarm.ts);
  if (!alarm.active) {
    members.read_time("cleared", alarm.cleared);
  }
  members.read_count("count", alarm.count);
  members.read("confirmed", alarm.confirmed);
  members.read("first", alarm.first);
  members.read_optional("record", alarm.record);
  read_errors(members, alarm.errors);
  members.expect(alarm.active != alarm.errors.empty(), "errors", "what \"active\" says");
  members.expect(!alarm.active || (!alarm.id.empty() && alarm.count > 0), "id", "there, or \"count\" is 0");
  return {std::move(alarm), members.wrong()};
}

}  // namespace alarms
