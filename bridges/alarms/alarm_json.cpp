#include "bridges/alarms/alarm_json.h"

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "bridges/text/json_text.h"
#include "bridges/text/timestamp.h"
#include "canopen/hex.h"

namespace alarms {
namespace {

std::string vendor_text(const std::array<std::uint8_t, 5>& vendor) {
  std::string text;
  for (const std::uint8_t byte : vendor) {
    text += canopen::hex(byte, 2);
  }
  return text;
}

// A time that never was is null.
void append_time(text::ObjectText& object, std::string_view name, canopen::WallTime time) {
  object.text(name, time == canopen::WallTime{} ? std::nullopt : std::optional(text::timestamp(time)));
}

void append_error(std::string& out, const AlarmError& error) {
  text::ObjectText object(out);
  object.text("code", "0x" + canopen::hex(error.code, 4));
  object.text("vendor", vendor_text(error.vendor));
  object.text("severity", name_of(error.severity));
  object.text("text", error.text);
  append_time(object, "since", error.since);
  object.close();
}

}  // namespace

std::string alarm_json(const Alarm& alarm) {
  std::string out;
  text::ObjectText object(out);
  object.boolean("active", alarm.active);
  object.text("id", alarm.id);
  object.text("code", "0x" + canopen::hex(alarm.code, 4));
  object.text("reason", alarm.reason);
  object.text("text", alarm.text);
  object.text("severity", name_of(alarm.severity));
  object.text("register", "0x" + canopen::hex(alarm.error_register, 2));
  object.text("vendor", vendor_text(alarm.vendor));
  append_time(object, "since", alarm.since);
  append_time(object, "ts", alarm.ts);
  if (!alarm.active) {
    append_time(object, "cleared", alarm.cleared);
  }
  object.integer("count", alarm.count);
  object.boolean("confirmed", alarm.confirmed);
  object.boolean("first", alarm.first);
  text::append_list(object.key("errors"), alarm.errors, append_error);
  if (!alarm.record.empty()) {
    object.text("record", alarm.record);
  }
  object.close();
  return out;
}

}  // namespace alarms
