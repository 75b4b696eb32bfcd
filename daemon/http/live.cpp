#include "daemon/http/live.h"

#include <utility>

#include "bridges/process/drive.h"
#include "bridges/process/plant_change.h"
#include "daemon/control/status_json.h"

namespace gateway::http {

Live::Live(const process::Plant& plant) : plant_(plant) {
  for (std::size_t i = 0; i < plant.size(); ++i) {
    drives_.push_back(make_shown(i));
  }
}

Live::Shown Live::make_shown(std::size_t drive) const {
  Shown shown;
  shown.values.resize(plant_.drive(drive).model().signals.size());
  return shown;
}

void Live::on_plant_change(const process::PlantChange& change) {
  drives_ = process::realigned(std::move(drives_), change.drives, [this](std::size_t i) { return make_shown(i); });
  ++health_;
  ++alarms_;
  alarms_begun_.reset();
}

void Live::append_rest(std::string& out, Place& place) {
  if (place.configuration != plant_.changes()) {
    // Its positions are those of other drives. It is told of all.
    place.drives.assign(drives_.size(), 0);
    place.next = 0;
    place.configuration = plant_.changes();
  }
  if (place.alarms < alarms_) {
    if (!word_alarms()) {
      place.more = true;
      return;
    }
    append_event(out, "alarms", alarms_text_);
    place.alarms = alarms_worded_;
  }
  std::size_t worded = 0;
  std::size_t looked = 0;
  for (; looked < drives_.size() && out.size() < kMostBytes && worded < kMostWorded; ++looked) {
    const std::size_t drive = place.next;
    Shown& shown = drives_[drive];
    place.next = (place.next + 1) % drives_.size();
    if (place.drives[drive] < shown.changed) {
      if (!is_worded(shown)) {
        word(drive);
        ++worded;
      }
      append_event(out, "drive", shown.text);
      place.drives[drive] = shown.changed;
    }
  }
  place.more = looked < drives_.size();
}

// What changes while a list is worded comes with the next list.
bool Live::word_alarms() {
  if (alarms_worded_ == alarms_) {
    return true;
  }
  const canopen::TimePoint now = canopen::Clock::now();
  // The reader that it was begun for may have left since.
  if (!alarms_begun_ || now - alarms_begun_->at > kSilence) {
    alarms_begun_.emplace(Begun{.list = AlarmList(plant_), .change = alarms_, .at = now, .text = {}});
  }
  if (alarms_begun_->list.word(alarms_begun_->text).goes_on) {
    return false;
  }
  alarms_text_ = std::move(alarms_begun_->text);
  alarms_worded_ = alarms_begun_->change;
  alarms_begun_.reset();
  return true;
}

// One that comes later is told no age of long ago.
bool Live::is_worded(const Shown& shown) {
  return shown.worded == shown.changed && canopen::Clock::now() - shown.at < kPace;
}

void Live::word(std::size_t drive) {
  Shown& shown = drives_[drive];
  shown.at = canopen::Clock::now();
  shown.text.clear();
  control::append_drive_status(shown.text, plant_, drive, shown.at);
  shown.worded = shown.changed;
}

// A value that comes again as it was is no change.
void Live::on_values(const process::Drive& drive, std::span<const process::SignalId> signals) {
  Shown& shown = drives_[drive.index()];
  bool differs = false;
  for (const process::SignalId signal : signals) {
    const canopen::Raw raw = drive.image().raw(signal);
    if (shown.values[signal] != raw) {
      shown.values[signal] = raw;
      differs = true;
    }
  }
  shown.changed += differs ? 1 : 0;
}

void Live::on_freshness(const process::Drive& drive, std::span<const process::SignalId> signals) {
  Shown& shown = drives_[drive.index()];
  for (const process::SignalId signal : signals) {
    shown.values[signal].reset();
  }
  ++shown.changed;
}

void Live::on_commanded(const process::Drive& drive, std::span<const process::SignalId> /*signals*/) {
  ++drives_[drive.index()].changed;
}

void Live::on_control(const process::Drive& drive) {
  ++drives_[drive.index()].changed;
}

void Live::on_status(const process::Drive& drive) {
  ++drives_[drive.index()].changed;
  ++health_;
}

void Live::on_alarm(const process::Drive& drive, alarms::AlarmKind /*kind*/) {
  ++drives_[drive.index()].changed;
  ++alarms_;
}

void Live::on_bus(std::size_t /*bus*/) {
  ++health_;
}

void Live::on_bus_alarm(std::size_t /*bus*/) {
  ++alarms_;
}

}  // namespace gateway::http
