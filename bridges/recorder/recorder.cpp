#include "bridges/recorder/recorder.h"

#include <algorithm>
#include <chrono>
#include <string_view>
#include <utility>

#include "bridges/process/plant_change.h"
#include "bridges/text/timestamp.h"
#include "config/log_interface.h"
#include "config/model.h"

namespace recorder {

using canopen::Clock;

Recorder::Recorder(const boost::asio::any_io_executor& executor, process::Plant& plant, KeptAt at,
                   std::function<bool(std::size_t bus, canopen::TimePoint until)> may_still_hear, Notices notices)
    : executor_(executor),
      plant_(plant),
      settings_(plant.model().recorder.value_or(config::Recorder{})),
      may_still_hear_(std::move(may_still_hear)),
      notices_(std::move(notices)),
      drives_(plant.size()),
      keeper_(executor, std::move(at), [this](const std::string& text) { notices_.warning(text); }) {
  for (std::size_t i = 0; i < plant.model().buses.size(); ++i) {
    lines_.push_back(make_line(i));
  }
}

std::unique_ptr<Recorder::Line> Recorder::make_line(std::size_t bus) {
  auto line = std::make_unique<Line>(executor_, settings_.before,
                                     most_frames(plant_.model().buses[bus].bitrate, settings_.before + settings_.after),
                                     [this](std::size_t at) { on_end(at); });
  line->bus = bus;
  return line;
}

void Recorder::on_plant_change(const process::PlantChange& change) {
  hand_over();
  for (const std::size_t bus : process::left_behind(change.buses, lines_.size())) {
    if (lines_[bus]->under_way) {
      finish(bus, "the configuration of the bus was changed");
    }
  }
  lines_ = process::realigned(std::move(lines_), change.buses, [this](std::size_t bus) { return make_line(bus); });
  for (std::size_t bus = 0; bus < lines_.size(); ++bus) {
    lines_[bus]->bus = bus;
  }
  drives_ = process::realigned(std::move(drives_), change.drives, [](std::size_t) { return OfDrive{}; });
}

/// A drive or a bus that is another one from now on has the alarms of before in a moment: those do not begin.
void Recorder::hand_over() {
  handed_over_.clear();
  const auto keep = [this](const Activation& one) {
    if (one.fault) {
      handed_over_.insert(one.id);
    }
  };
  for (const OfDrive& drive : drives_) {
    std::ranges::for_each(drive, keep);
  }
  for (const auto& line : lines_) {
    keep(line->alarm);
  }
}

void Recorder::start() {
  for (std::size_t i = 0; i < drives_.size(); ++i) {
    for (const alarms::AlarmKind kind : alarms::kAlarmKinds) {
      drives_[i].at(static_cast<std::size_t>(kind)) = activation(plant_.drive(i).alarm(kind));
    }
  }
  for (const auto& line : lines_) {
    line->alarm = activation(plant_.bus_alarm(line->bus));
  }
  started_ = true;
  keeper_.start({.kept = [this](const Record& record) { on_kept(record); }, .changed = [this] { forget_removed(); }});
}

boost::asio::awaitable<void> Recorder::stop() {
  for (std::size_t bus = 0; bus < lines_.size(); ++bus) {
    if (lines_[bus]->under_way) {
      finish(bus, "the gateway ended");
    }
  }
  started_ = false;
  co_await keeper_.stop();
}

void Recorder::on_command_done(const process::Drive& drive, const process::CommandRecord& record,
                               const process::Outcome& outcome) {
  const canopen::TimePoint now = Clock::now();
  Line& line = *lines_[drive.bus()];
  const canopen::TimePoint wanted = now - settings_.before;
  line.commands.add(command_text(record, outcome, now), now,
                    line.under_way ? std::min(wanted, line.under_way->from) : wanted);
}

void Recorder::on_alarm(const process::Drive& drive, alarms::AlarmKind kind) {
  const alarms::Alarm& alarm = drive.alarm(kind);
  const bool is_begin = begins(alarm, drives_[drive.index()].at(static_cast<std::size_t>(kind)));
  note(drive.bus(), {drive.model().name, kind, alarm, alarm}, is_begin);
}

void Recorder::on_bus_alarm(std::size_t bus) {
  const alarms::Alarm& alarm = plant_.bus_alarm(bus);
  const bool is_begin = begins(alarm, lines_[bus]->alarm);
  note(bus, {{}, std::nullopt, alarm, alarm}, is_begin);
}

Recorder::Activation Recorder::activation(const alarms::Alarm& alarm) {
  return {alarm.id, alarm.known && alarm.active && alarm.severity == config::Severity::fault};
}

bool Recorder::begins(const alarms::Alarm& alarm, Activation& before) const {
  Activation now = activation(alarm);
  const bool handed_over = before.id.empty() && handed_over_.contains(now.id);
  const bool begins = started_ && now.fault && (!before.fault || now.id != before.id) && !handed_over;
  before = std::move(now);
  return begins;
}

void Recorder::note(std::size_t bus, RecordedAlarm now, bool is_begin) {
  std::optional<UnderWay>& under_way = lines_[bus]->under_way;
  // It waits for frames of before its end only: those of this fault are behind. The next one has both.
  if (under_way && is_begin && Clock::now() > under_way->until) {
    finish(bus, {});
  }
  if (under_way) {
    std::vector<RecordedAlarm>& known = under_way->record.alarms;
    const auto is_same = [&now](const RecordedAlarm& one) { return one.alarm.id == now.alarm.id; };
    const auto same = std::ranges::find_if(known, is_same);
    if (same != known.end()) {
      same->change(std::move(now.at_end));
    } else if (is_begin && known.size() >= Record::kMostAlarms) {
      ++under_way->record.alarms_left_out;
    } else if (is_begin) {
      known.push_back(std::move(now));
    }
    return;
  }
  const std::string subject = now.kind ? now.drive : plant_.model().buses[bus].name;
  if (is_begin && is_allowed(now.kind ? "drive " + subject : "bus " + subject, false)) {
    UnderWay& begun =
        begin(bus, {canopen::wall_now(), subject, std::string(now.kind ? alarms::name_of(*now.kind) : "bus")});
    begun.record.drive = now.drive;
    begun.record.alarms.push_back(std::move(now));
  }
}

bool Recorder::is_allowed(const std::string& subject, bool requested) {
  const Quota::Verdict verdict = quota_.take((requested ? "requests of " : "") + subject, Clock::now());
  if (verdict.first_refusal) {
    notices_.warning(subject + ": " + std::to_string(Quota::kMost) + " records " +
                     (requested ? "were asked for within an hour; further ones are refused"
                                : "of faults within an hour; further ones are not recorded") +
                     " until the first is an hour old");
  }
  if (verdict.refused_before > 0) {
    notices_.info(subject + ": is recorded again; " + std::to_string(verdict.refused_before) +
                  (requested ? " requests were refused" : " faults were not recorded"));
  }
  return verdict.allowed;
}

Recorder::UnderWay& Recorder::begin(std::size_t bus, RecordName name) {
  Line& line = *lines_[bus];
  const canopen::TimePoint now = Clock::now();
  name.wall = std::chrono::floor<std::chrono::milliseconds>(name.wall);
  const auto is_taken = [this](const std::string& stem) {
    return keeper_.knows(stem) || std::ranges::any_of(lines_, [&stem](const auto& other) {
             return other->under_way && to_text(other->under_way->record.name) == stem;
           });
  };
  while (is_taken(to_text(name))) {  // Somebody may have set the time of day back.
    name.wall += std::chrono::milliseconds(1);
  }
  const config::Bus& model = plant_.model().buses[bus];
  UnderWay& begun = line.under_way.emplace();
  begun.from = now - settings_.before;
  begun.until = now + settings_.after;
  begun.record = {.name = std::move(name),
                  .bus = model.name,
                  .interface = std::string(config::log_interface(model)),
                  .bitrate = model.bitrate,
                  .from = canopen::wall_now() - settings_.before,
                  .until = canopen::wall_now() + settings_.after};
  line.ring.hold(begun.from);
  line.end.arm(begun.until);
  return begun;
}

canopen::Result<Recorder::Requested> Recorder::request(std::size_t bus, const std::string& drive,
                                                       const std::string& user) {
  const auto told = [](const UnderWay& under_way, bool before) {
    return Requested{.name = to_text(under_way.record.name) + std::string(kLogSuffix),
                     .was_under_way = before,
                     .remaining = std::max(canopen::Duration::zero(), under_way.until - Clock::now())};
  };
  if (lines_[bus]->under_way) {
    return told(*lines_[bus]->under_way, true);
  }
  const std::string& subject = drive.empty() ? plant_.model().buses[bus].name : drive;
  if (!started_) {
    return canopen::Error{.kind = canopen::ErrorKind::offline,
                          .detail = "nothing is recorded while the gateway starts or ends"};
  }
  if (!is_allowed((drive.empty() ? "bus " : "drive ") + subject, true)) {
    return canopen::Error{.kind = canopen::ErrorKind::forbidden,
                          .detail = "there were " + std::to_string(Quota::kMost) + " requests for records of " +
                                    subject + " within the last hour"};
  }
  UnderWay& begun = begin(bus, {canopen::wall_now(), subject, std::string(kRequest)});
  begun.record.drive = drive;
  begun.record.requested_by = user;
  return told(begun, false);
}

void Recorder::on_end(std::size_t bus) {
  const std::optional<UnderWay>& under_way = lines_[bus]->under_way;
  if (!under_way) {
    return;
  }
  if (may_still_hear_(bus, under_way->until)) {
    lines_[bus]->end.arm(canopen::or_soon(under_way->until));
    return;
  }
  finish(bus, {});
}

void Recorder::finish(std::size_t bus, std::string ended) {
  Line& line = *lines_[bus];
  UnderWay under_way = *std::exchange(line.under_way, std::nullopt);
  line.end.cancel();
  under_way.record.ended = std::move(ended);
  under_way.record.frames = line.ring.slice(under_way.from, under_way.until);
  line.ring.release();
  CommandTrail::Taken taken = line.commands.since(under_way.from);
  under_way.record.commands = std::move(taken.commands);
  under_way.record.commands_left_out = taken.left_out;
  keeper_.post(std::move(under_way.record));
}

void Recorder::on_kept(const Record& record) {
  const std::string name = to_text(record.name) + std::string(kLogSuffix);
  notices_.info(record.bus + ": record " + name + " is kept");
  for (const RecordedAlarm& alarm : record.alarms) {
    set_record(record.bus, alarm, name);
  }
}

void Recorder::set_record(const std::string& bus, const RecordedAlarm& alarm, const std::string& name) {
  process::Drive* const drive = alarm.kind ? plant_.find(alarm.drive) : nullptr;
  if (drive != nullptr && drive->alarm(*alarm.kind).id == alarm.alarm.id) {
    drive->set_record(*alarm.kind, name);
    return;
  }
  const auto at = config::find_named(plant_.model().buses, bus);
  if (!alarm.kind && at && plant_.bus_alarm(*at).id == alarm.alarm.id) {
    plant_.set_bus_record(*at, name);
  }
}

void Recorder::forget_removed() {
  if (!keeper_.records()) {
    return;  // Nobody knows what there is.
  }
  const auto is_gone = [this](std::string_view name) {
    return !name.empty() &&
           (!name.ends_with(kLogSuffix) || !keeper_.knows(name.substr(0, name.size() - kLogSuffix.size())));
  };
  for (std::size_t i = 0; i < plant_.size(); ++i) {
    for (const alarms::AlarmKind kind : alarms::kAlarmKinds) {
      if (is_gone(plant_.drive(i).alarm(kind).record)) {
        plant_.drive(i).set_record(kind, {});
      }
    }
  }
  for (std::size_t bus = 0; bus < lines_.size(); ++bus) {
    if (is_gone(plant_.bus_alarm(bus).record)) {
      plant_.set_bus_record(bus, {});
    }
  }
}

}  // namespace recorder
