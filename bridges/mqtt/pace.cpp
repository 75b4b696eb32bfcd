#include "bridges/mqtt/pace.h"

#include <algorithm>
#include <cmath>

#include "bridges/mqtt/expiry.h"

namespace mqtt {
namespace {

using canopen::kNever;

// A change of exactly the deadband is none, whatever the last bit of a double says.
constexpr double kRounding = 1.0 + 1e-9;

bool exceeds_deadband(const config::Signal& signal, canopen::Raw before, canopen::Raw now) {
  const double steps = std::abs(canopen::to_number(signal.type, now) - canopen::to_number(signal.type, before));
  const double change = steps * std::abs(signal.scale);
  return !std::isfinite(change) || change > signal.deadband * kRounding;
}

}  // namespace

Pace::Pace(const config::Drive& drive, const config::Mqtt& settings)
    : drive_(drive), settings_(settings), signals_(drive.signals.size()) {
  for (std::size_t i = 0; i < signals_.size(); ++i) {
    signals_[i].shape = shape_of(drive, static_cast<process::SignalId>(i));
    signals_[i].readable = config::readable(drive.signals[i].access);
  }
}

canopen::TimePoint Pace::note(process::SignalId signal, canopen::Raw raw, bool fresh) {
  Entry& entry = signals_[signal];
  if (!entry.readable) {
    return kNever;
  }
  entry.pending = changed(entry, drive_.signals[signal], raw, fresh);
  if (!entry.pending) {
    entry.urgent = false;
    return kNever;
  }
  entry.urgent = entry.shape != Shape::number || fresh != entry.fresh;
  switched_ = switched_ || entry.shape != Shape::number;
  state_pending_ = true;
  state_urgent_ = state_urgent_ || entry.urgent;
  canopen::TimePoint at = kNever;
  if (settings_.signals) {
    at = std::min(at, due(entry));
  }
  if (settings_.state) {
    at = std::min(at, state_due_at());
  }
  return at;
}

void Pace::forget() {
  for (Entry& entry : signals_) {
    entry.at.reset();
  }
  state_at_.reset();
}

bool Pace::signal_due(process::SignalId signal, canopen::TimePoint now) const {
  return settings_.signals && signals_[signal].readable && due(signals_[signal]) <= now;
}

bool Pace::state_due(canopen::TimePoint now) const {
  return settings_.state && state_due_at() <= now;
}

void Pace::published_signal(process::SignalId signal, canopen::Raw raw, bool fresh, canopen::TimePoint now) {
  Entry& entry = signals_[signal];
  entry.pending = false;
  entry.urgent = false;
  entry.raw = raw;
  entry.fresh = fresh;
  entry.at = now;
}

void Pace::published_state(canopen::TimePoint now) {
  state_pending_ = false;
  state_urgent_ = false;
  state_at_ = now;
}

canopen::TimePoint Pace::next() const {
  canopen::TimePoint next = settings_.state ? state_due_at() : kNever;
  if (settings_.signals) {
    for (const Entry& entry : signals_) {
      next = std::min(next, due(entry));
    }
  }
  return next;
}

bool Pace::changed(const Entry& entry, const config::Signal& signal, canopen::Raw raw, bool fresh) const {
  if (!entry.at || fresh != entry.fresh) {
    return true;
  }
  if (!fresh || ((raw ^ entry.raw) & signal.publish_mask) == 0) {
    return false;
  }
  return entry.shape != Shape::number || signal.deadband <= 0.0 || exceeds_deadband(signal, entry.raw, raw);
}

canopen::TimePoint Pace::due(const Entry& entry) const {
  if (!entry.readable) {
    return kNever;
  }
  if (!entry.at || (entry.pending && entry.urgent)) {
    return kAtOnce;
  }
  if (entry.pending) {
    return *entry.at + settings_.min_interval;
  }
  // One that shows no value says the same for good.
  return entry.fresh ? *entry.at + refresh_interval(settings_) : kNever;
}

canopen::TimePoint Pace::state_due_at() const {
  if (!state_at_ || state_urgent_) {
    return kAtOnce;
  }
  return *state_at_ + (state_pending_ ? settings_.min_interval : refresh_interval(settings_));
}

}  // namespace mqtt
