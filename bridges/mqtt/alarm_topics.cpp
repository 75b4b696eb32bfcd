#include "bridges/mqtt/alarm_topics.h"

#include <algorithm>
#include <string>
#include <utility>

#include "bridges/alarms/active_alarms_json.h"
#include "bridges/alarms/alarm_json.h"

namespace mqtt {

AlarmTopics::AlarmTopics(const process::Plant& plant, const Topics& topics) : plant_(plant), topics_(topics) {
  add_all();
}

void AlarmTopics::add_all() {
  for (std::size_t i = 0; i < plant_.size(); ++i) {
    for (const alarms::AlarmKind kind : alarms::kAlarmKinds) {
      add(topics_.drive(i).alarms.at(static_cast<std::size_t>(kind)), &plant_.drive(i).alarm(kind));
    }
  }
  for (std::size_t bus = 0; bus < plant_.model().buses.size(); ++bus) {
    add(topics_.bus_alarm(bus), &plant_.bus_alarm(bus));
  }
  add(topics_.alarms(), nullptr);
}

void AlarmTopics::add(const std::string& topic, const alarms::Alarm* alarm) {
  positions_.emplace(topic, entries_.size());
  entries_.push_back({.topic = &topic, .alarm = alarm, .kept = {}});
}

void AlarmTopics::change(const process::PlantChange& change, canopen::TimePoint now) {
  const std::vector<Entry> before = std::exchange(entries_, {});
  const std::unordered_map<std::string, std::size_t> positions = std::exchange(positions_, {});
  add_all();
  for (Entry& entry : entries_) {
    if (const auto known = positions.find(*entry.topic); known != positions.end()) {
      entry.kept = before[known->second].kept;
    }
  }
  bool any_new = false;
  for (std::size_t i = 0; i < change.drives.size(); ++i) {
    for (const alarms::AlarmKind kind : alarms::kAlarmKinds) {
      if (!change.drives[i]) {
        any_new = true;
        mark(plant_.drive(i), kind, now);
      }
    }
  }
  for (std::size_t bus = 0; bus < change.buses.size(); ++bus) {
    if (!change.buses[bus]) {
      any_new = true;
      mark_bus(bus, now);
    }
  }
  list_known_ = list_known_ && !any_new;
  entries_.back().kept.changed(now);
}

canopen::TimePoint AlarmTopics::mark(const process::Drive& drive, alarms::AlarmKind kind, canopen::TimePoint now) {
  return mark(drive.index() * alarms::kAlarmKinds.size() + static_cast<std::size_t>(kind), now);
}

canopen::TimePoint AlarmTopics::mark_bus(std::size_t bus, canopen::TimePoint now) {
  return mark(plant_.size() * alarms::kAlarmKinds.size() + bus, now);
}

canopen::TimePoint AlarmTopics::mark(std::size_t position, canopen::TimePoint now) {
  return std::min(entries_.at(position).kept.changed(now), entries_.back().kept.changed(now));
}

void AlarmTopics::mark_all() {
  for (Entry& entry : entries_) {
    entry.kept.forget();
  }
}

canopen::TimePoint AlarmTopics::received(const Incoming& message, canopen::TimePoint now) {
  const auto position = positions_.find(message.topic);
  // What the broker kept from before it was subscribed to (MQTT 3.1.1) is older than all that we published since.
  if (position == positions_.end() || message.retained) {
    return canopen::kNever;
  }
  return entries_[position->second].kept.received(message.payload, now);
}

canopen::TimePoint AlarmTopics::collect(canopen::TimePoint now, std::vector<Message>& out) {
  canopen::TimePoint next = canopen::kNever;
  for (Entry& entry : entries_) {
    if (entry.kept.next() <= now) {
      collect(entry, now, out);
    }
    next = std::min(next, entry.kept.next());
  }
  return next;
}

void AlarmTopics::collect_last(std::vector<Message>& out) {
  for (Entry& entry : entries_) {
    // A change may turn out to be none while the topic is still to be put right.
    for (canopen::TimePoint due = entry.kept.next(); due != canopen::kNever; due = entry.kept.next()) {
      collect(entry, due, out);
    }
  }
}

void AlarmTopics::collect(Entry& entry, canopen::TimePoint now, std::vector<Message>& out) {
  const bool known = entry.alarm != nullptr ? entry.alarm->known : list_is_known();
  if (!known) {
    entry.kept.withhold();
    return;
  }
  std::string word = entry.alarm == nullptr ? list() : alarms::alarm_json(*entry.alarm);
  if (entry.kept.offer(word, now)) {
    out.push_back({.topic = *entry.topic,
                   .payload = std::move(word),
                   .kind = MessageKind::alarm,
                   .puts_right = entry.kept.puts_right()});
  }
}

// An empty list would say that nothing is wrong before anybody knows.
bool AlarmTopics::list_is_known() {
  const auto active = [](const Entry& entry) {
    return entry.alarm != nullptr && entry.alarm->known && entry.alarm->active;
  };
  const auto known = [](const Entry& entry) { return entry.alarm == nullptr || entry.alarm->known; };
  list_known_ = list_known_ || std::ranges::any_of(entries_, active) || std::ranges::all_of(entries_, known);
  return list_known_;
}

std::string AlarmTopics::list() const {
  std::vector<alarms::ListedAlarm> listed;
  for (const process::ActiveAlarm& active : plant_.active_alarms()) {
    if (active.drive != nullptr) {
      listed.push_back({.drive = active.drive->model().name, .kind = active.kind, .alarm = active.alarm});
    } else {
      listed.push_back({.bus = plant_.model().buses[active.bus].name, .alarm = active.alarm});
    }
  }
  return alarms::active_alarms_json(listed);
}

}  // namespace mqtt
