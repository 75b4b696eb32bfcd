#include "daemon/control/watch_stream.h"

#include <functional>
#include <utility>

#include "daemon/control/status_json.h"

namespace gateway::control {

WatchStream::WatchStream(const process::Plant& plant, std::string id, canopen::TimePoint started, Surveys surveys)
    : plant_(plant), id_(std::move(id)), started_(started), surveys_(std::move(surveys)) {}

bool WatchStream::take(std::string& lines) {
  if (!drive_ || configuration_ != plant_.changes()) {
    begin();
  }
  for (std::size_t i = 0; i < kDrivesAtOnce && *drive_ < plant_.size(); ++i) {
    add_drive();
  }
  if (*drive_ < plant_.size()) {
    return true;
  }
  drive_.reset();
  const canopen::TimePoint now = canopen::Clock::now();
  if (told_ != hash_ || now - told_at_ >= kSilence) {
    lines += "{\"id\":" + id_ + ",\"status\":" + status_ + "]}}\n";
    told_ = hash_;
    told_at_ = now;
  }
  return false;
}

void WatchStream::begin() {
  drive_ = 0;
  configuration_ = plant_.changes();
  hash_ = 0;
  status_ = status_head(plant_, started_, canopen::Clock::now(), surveys_);
  for (std::size_t i = 0; i < plant_.model().buses.size(); ++i) {
    note(static_cast<std::size_t>(plant_.bus_state(i).condition));
  }
}

void WatchStream::add_drive() {
  const canopen::TimePoint now = canopen::Clock::now();
  status_ += *drive_ == 0 ? "" : ",";
  append_drive_status(status_, plant_, *drive_, now);
  std::string lasting;
  append_drive_status(lasting, plant_, *drive_, now, Ages::hidden);
  note(std::hash<std::string>{}(lasting));
  ++*drive_;
}

}  // namespace gateway::control
