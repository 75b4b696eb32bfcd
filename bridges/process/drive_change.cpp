// What a change of the configuration, in the running gateway, asks of a drive.

#include <utility>

#include "bridges/process/drive.h"

namespace process {

void Drive::leave() {
  static const std::vector<Observer*> nobody;
  observers_ = &nobody;
  doubled_changed_ = {};
  alarms_.on_fault_began({});
}

Turning Drive::turning() const {
  if (!status().online) {
    return Turning::no;
  }
  if (!running_) {
    return Turning::untold;
  }
  // What comes only when it changes says with its silence that it did not.
  const SourceState& source = image_.sources()[running_->source];
  const canopen::TimePoint seen = source.fresh_until == canopen::TimePoint::max() ? canopen::Clock::now() : source.at;
  if (commands_.is_told_to_run(seen)) {
    return Turning::yes;  // The motor may only be about to follow.
  }
  if (!image_.fresh(running_->signal, canopen::Clock::now())) {
    return Turning::unknown;
  }
  return image_.raw(running_->signal) != 0 ? Turning::yes : Turning::no;
}

void Drive::set_pending_change(std::string waits_for) {
  if (pending_change_ == waits_for) {
    return;
  }
  pending_change_ = std::move(waits_for);
  for (Observer* observer : *observers_) {
    observer->on_status(*this);
  }
}

}  // namespace process
