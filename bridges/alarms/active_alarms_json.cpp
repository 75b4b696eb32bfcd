#include "bridges/alarms/active_alarms_json.h"

#include "bridges/text/json_text.h"
#include "bridges/text/timestamp.h"
#include "canopen/hex.h"

namespace alarms {

void append_listed(std::string& out, const ListedAlarm& listed) {
  const Alarm& alarm = *listed.alarm;
  text::ObjectText object(out);
  if (listed.drive.empty()) {
    object.text("bus", listed.bus);
    object.text("kind", "bus");
  } else {
    object.text("drive", listed.drive);
    object.text("kind", name_of(listed.kind));
  }
  object.text("code", "0x" + canopen::hex(alarm.code, 4));
  object.text("reason", alarm.reason);
  object.text("text", alarm.text);
  object.text("severity", name_of(alarm.severity));
  object.text("since", text::timestamp(alarm.since));
  object.boolean("first", alarm.first);
  if (!alarm.record.empty()) {
    object.text("record", alarm.record);
  }
  object.close();
}

std::string active_alarms_json(std::span<const ListedAlarm> active) {
  std::string out;
  text::append_list(out, active, append_listed);
  return out;
}

}  // namespace alarms
