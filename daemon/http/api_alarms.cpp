#include <utility>

#include "daemon/http/alarm_list.h"
#include "daemon/http/respond.h"

namespace gateway::http {

AlarmList::AlarmList(const process::Plant& plant) {
  for (const process::ActiveAlarm& active : plant.active_alarms()) {
    const alarms::Alarm& alarm = *active.alarm;
    Listed& listed = listed_.emplace_back();
    listed.alarm.code = alarm.code;
    listed.alarm.reason = alarm.reason;
    listed.alarm.text = alarm.text;
    listed.alarm.severity = alarm.severity;
    listed.alarm.since = alarm.since;
    listed.alarm.first = alarm.first;
    listed.alarm.record = alarm.record;
    listed.place.kind = active.kind;
    (active.drive != nullptr ? listed.place.drive : listed.place.bus) =
        active.drive != nullptr ? active.drive->model().name : plant.model().buses[active.bus].name;
  }
}

Progress AlarmList::word(std::string& out, std::size_t most) {
  out += next_ == 0 ? "[" : "";
  for (std::size_t worded = 0; worded < most && next_ < listed_.size(); ++worded, ++next_) {
    out += next_ == 0 ? "" : ",";
    Listed& listed = listed_[next_];
    listed.place.alarm = &listed.alarm;
    alarms::append_listed(out, listed.place);
  }
  const bool goes_on = next_ < listed_.size();
  out += goes_on ? "" : "]";
  return {.goes_on = goes_on, .kept = (listed_.size() - next_) * sizeof(Listed)};
}

Answer active_alarms(const Site& site) {
  Answer answer;
  answer.rest = [list = AlarmList(site.plant)](std::string& text) mutable { return list.word(text); };
  return answer;
}

}  // namespace gateway::http
