#include "bridges/modbus/known_commands.h"

#include <algorithm>

namespace modbus {
namespace {

bool is_set(const process::Image& image, const std::optional<std::size_t>& signal, canopen::TimePoint now) {
  if (!signal) {
    return false;
  }
  const auto id = static_cast<process::SignalId>(*signal);
  return image.raw(id) != 0 && image.fresh(id, now);
}

}  // namespace

KnownCommands::KnownCommands(const config::Drive& drive)
    : drive_(drive), confirmed_(drive.signals.size()), forgotten_(drive.signals.size()) {}

void KnownCommands::observe(const process::Drive& drive, canopen::TimePoint now) {
  const canopen::NodeStatus& status = drive.status();
  const Seen next{
      .operational = status.online && status.nmt == canopen::NmtState::operational,
      .running = is_set(drive.image(), drive_.faults.running, now),
      .quick_stop = is_set(drive.image(), drive_.faults.quick_stop, now),
      .fault = drive.has_fault_alarm() || is_set(drive.image(), drive_.faults.fault, now),
      .boot_ups = status.boot_ups,
  };
  if ((seen_.operational && !next.operational) || (seen_.running && !next.running) ||
      (!seen_.quick_stop && next.quick_stop) || seen_.fault != next.fault || seen_.boot_ups != next.boot_ups) {
    std::ranges::fill(confirmed_, std::nullopt);
  }
  seen_ = next;
}

void KnownCommands::confirm(process::SignalId signal, canopen::Raw raw, canopen::TimePoint now) {
  if (config::is_momentary(drive_.signals[signal], raw)) {
    confirmed_[signal].reset();
  } else {
    confirmed_[signal] = now;
  }
}

void KnownCommands::forget(process::SignalId signal, canopen::TimePoint now) {
  if (confirmed_[signal] != now) {  // Else it was confirmed, only that it counts for nothing.
    forgotten_[signal] = now;
  }
  confirmed_[signal].reset();
}

std::optional<canopen::TimePoint> KnownCommands::confirmed_at(process::SignalId signal) const {
  return confirmed_[signal];
}

std::optional<canopen::TimePoint> KnownCommands::forgotten_at(process::SignalId signal) const {
  return forgotten_[signal];
}

}  // namespace modbus
