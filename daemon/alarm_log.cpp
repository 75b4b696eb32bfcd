#include "daemon/alarm_log.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <utility>

#include "bridges/process/plant_change.h"

namespace gateway {
namespace {

using alarms::Alarm;
using alarms::AlarmKind;

constexpr std::size_t kKinds = alarms::kAlarmKinds.size();

spdlog::level::level_enum level_of(const Alarm& alarm) noexcept {
  if (!alarm.active) {
    return spdlog::level::info;
  }
  return alarm.severity == config::Severity::fault ? spdlog::level::err : spdlog::level::warn;
}

std::string state_of(const Alarm& alarm) {
  std::string text = alarm.active ? "active" : "over";
  if (alarm.active && !alarm.confirmed) {
    text += ", not confirmed";
  }
  return alarm.active && alarm.first ? text + ", first" : text;
}

// `0x0005 Overcurrent`, `never-appeared: the drive has not appeared on the bus`.
std::string what_of(const Alarm& alarm, AlarmKind kind) {
  if (kind == AlarmKind::emcy) {
    return fmt::format("0x{:04X} {}", alarm.code, alarm.text);
  }
  return alarm.reason.empty() ? alarm.text : alarm.reason + ": " + alarm.text;
}

// Activations that had no line; the one that is active now has it here.
std::string left_out(const Alarm& alarm, std::optional<std::uint32_t> told) {
  const std::uint32_t since = alarm.count - told.value_or(alarm.count);
  const std::uint32_t without = alarm.active && since > 0 ? since - 1 : since;
  return without > 0 ? fmt::format(" ({} more in between)", without) : std::string();
}

}  // namespace

AlarmLog::AlarmLog(const boost::asio::any_io_executor& executor, const process::Plant& plant, Write write)
    : plant_(plant),
      write_(std::move(write)),
      subjects_(plant.model().drives.size() * kKinds + plant.model().buses.size()),
      buses_(plant.model().buses.size()),
      next_(executor, [this] { tell_due(); }) {}

void AlarmLog::on_alarm(const process::Drive& drive, AlarmKind kind) {
  const std::size_t subject = drive.index() * kKinds + static_cast<std::size_t>(kind);
  const Alarm& alarm = drive.alarm(kind);
  // What was over before our start is no news when it is decided.
  if (alarm.known && !alarm.id.empty() && (alarm.active || !subjects_[subject].line.empty())) {
    note(subject);
  }
}

void AlarmLog::on_bus(std::size_t bus) {
  if (!plant_.bus_alarm(bus).confirmed) {
    return;  // From memory: the bus has not told its state yet.
  }
  note(of_drives() + bus);
}

void AlarmLog::on_plant_change(const process::PlantChange& change) {
  std::vector<Subject> before = std::move(subjects_);
  const std::size_t of_drives_before = before.size() - buses_;
  subjects_.clear();
  handed_over_.clear();
  for (const Subject& one : before) {
    if (!one.line.empty() && !one.id.empty()) {
      handed_over_[one.id] = one;
    }
  }
  for (const auto& from : change.drives) {
    for (std::size_t kind = 0; kind < kKinds; ++kind) {
      subjects_.push_back(from ? std::move(before[*from * kKinds + kind]) : Subject{});
    }
  }
  for (const auto& from : change.buses) {
    subjects_.push_back(from ? std::move(before[of_drives_before + *from]) : Subject{});
  }
  buses_ = change.buses.size();
}

void AlarmLog::note(std::size_t subject) {
  if (const auto before = handed_over_.find(alarm_of(subject).id);
      before != handed_over_.end() && subjects_[subject].line.empty()) {
    subjects_[subject].line = before->second.line;
    subjects_[subject].id = before->second.id;
    subjects_[subject].count = before->second.count;
  }
  if (is_told(subject)) {
    return;  // Only its time, or a counter.
  }
  const canopen::TimePoint now = canopen::Clock::now();
  if (const canopen::TimePoint due = subjects_[subject].pace.note(now); due > now) {
    next_.arm_no_later_than(due);
  } else {
    tell(subject);
  }
}

void AlarmLog::tell_due() {
  const canopen::TimePoint now = canopen::Clock::now();
  canopen::TimePoint next = canopen::kNever;
  for (std::size_t i = 0; i < subjects_.size(); ++i) {
    if (subjects_[i].pace.due(now)) {
      tell(i);
    }
    next = std::min(next, subjects_[i].pace.next());
  }
  if (next != canopen::kNever) {
    next_.arm(next);
  }
}

void AlarmLog::finish() {
  next_.cancel();
  for (std::size_t i = 0; i < subjects_.size(); ++i) {
    if (subjects_[i].pace.next() != canopen::kNever) {
      tell(i);
    }
  }
}

void AlarmLog::tell(std::size_t subject) {
  Subject& told = subjects_[subject];
  told.pace.told(canopen::Clock::now());
  if (is_told(subject)) {
    return;  // It went back to that.
  }
  const Line line = line_of(subject);
  write_(line.level, line.text);
  const Alarm& alarm = alarm_of(subject);
  told.id = alarm.id;
  told.count = alarm.count;
  told.line = line_of(subject).text;  // Without what was left out.
}

bool AlarmLog::is_told(std::size_t subject) const {
  return line_of(subject).text == subjects_[subject].line && alarm_of(subject).id == subjects_[subject].id;
}

AlarmLog::Line AlarmLog::line_of(std::size_t subject) const {
  if (subject < of_drives()) {
    return line_of(plant_.drive(subject / kKinds), alarms::kAlarmKinds.at(subject % kKinds), subjects_[subject]);
  }
  const std::size_t bus = subject - of_drives();
  const Alarm& alarm = plant_.bus_alarm(bus);
  return {level_of(alarm),
          fmt::format("bus {}: {}{}{}", plant_.model().buses[bus].name, alarm.active && alarm.first ? "first: " : "",
                      alarm.active ? alarm.text : canopen::describe(plant_.bus_state(bus).condition),
                      left_out(alarm, subjects_[subject].count))};
}

AlarmLog::Line AlarmLog::line_of(const process::Drive& drive, AlarmKind kind, const Subject& subject) const {
  const Alarm& alarm = drive.alarm(kind);
  return {level_of(alarm), fmt::format("{}: alarm {} {}: {}{}", drive.model().name, alarms::name_of(kind),
                                       state_of(alarm), what_of(alarm, kind), left_out(alarm, subject.count))};
}

const Alarm& AlarmLog::alarm_of(std::size_t subject) const {
  return subject < of_drives() ? plant_.drive(subject / kKinds).alarm(alarms::kAlarmKinds.at(subject % kKinds))
                               : plant_.bus_alarm(subject - of_drives());
}

}  // namespace gateway
