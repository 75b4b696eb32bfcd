#include "canopen/bus/in_flight.h"

#include <algorithm>
#include <chrono>
#include <utility>

namespace canopen {
namespace {

// One that can move a motor, SYNC, heartbeat and a guarding request, one of SDO.
constexpr std::size_t kUsually = 5;
// Where nothing is received at all.
constexpr Duration kLongestWait = std::chrono::seconds(1);

}  // namespace

void tell(Ticket::Told& told, Departure departure) {
  if (const Ticket::Told once = std::exchange(told, nullptr)) {
    once(departure);
  }
}

InFlight::InFlight(TransmitTimes times, bool has_heartbeat) : times_(times), has_heartbeat_(has_heartbeat) {
  entries_.reserve(kUsually);
}

void InFlight::add(Outgoing outgoing, TimePoint now) {
  const TimePoint late = now + times_.echo;
  entries_.push_back({.frame = outgoing.frame,
                      .transmit_class = outgoing.transmit_class,
                      .since = now,
                      .look_at = is_command(outgoing.transmit_class) ? std::min(outgoing.until, late) : late,
                      .id = outgoing.id,
                      .told = std::move(outgoing.told),
                      .number = ++handed_over_,
                      .lost_at = {}});
}

// The oldest frame with this content is the one. Frames before it have lost their echo (a receive overrun), or follow
// at once where a controller has several mailboxes: none is kept in front of later ones, so that a lost echo shifts
// nothing.
void InFlight::on_echo(const Frame& frame, TimePoint at) {
  const auto found =
      std::find_if(entries_.begin(), entries_.end(), [&](const Entry& entry) { return entry.frame == frame; });
  const std::uint64_t number = found == entries_.end() ? 0 : found->number;
  for (Entry& entry : entries_) {
    if (entry.number == number) {
      tell(entry.told, Departure::left);
      entry.gone = true;
    } else if (!proves(frame.id, entry.frame.id)) {
      continue;
    } else if (entry.number < number) {
      entry.passed = true;
      entry.gone = !is_command(entry.transmit_class) || entry.overdue;
    } else if (entry.overdue && !entry.lost_at) {
      entry.lost_at = at + times_.echo;
    }
  }
  if (forgotten_ && proves(frame.id, forgotten_->cob_id)) {
    const bool is_later = number > forgotten_->number;
    const bool is_itself = number == 0 && frame == forgotten_->newest;
    if (is_later || is_itself) {
      forgotten_.reset();
    }
  }
  erase_gone();
}

void InFlight::on_frames_lost() {
  for (Entry& entry : entries_) {
    entry.doubtful = true;
    if (!is_motion(entry.transmit_class)) {
      forget(entry);
    }
  }
  erase_gone();
}

// The kernel drops what it had. But a controller may keep one frame over a bus-off.
void InFlight::on_down() {
  for (Entry& entry : entries_) {
    if (is_motion(entry.transmit_class)) {
      tell(entry.told, Departure::unknown);
      entry.overdue = true;
      entry.lost_at.reset();
    } else {
      forget(entry);
    }
  }
  erase_gone();
}

void InFlight::forget_told(std::uint64_t id) {
  for (Entry& entry : entries_) {
    if (entry.id == id) {
      entry.told = nullptr;
    }
  }
}

bool InFlight::any_late(TimePoint now) const noexcept {
  return std::any_of(entries_.begin(), entries_.end(), [now](const Entry& entry) {
    return now >= (entry.overdue ? entry.lost_at.value_or(kNever) : entry.look_at);
  });
}

void InFlight::give_up_late(TimePoint now, std::optional<TimePoint> last_sign_of_life) {
  looked_ = now;
  for (Entry& entry : entries_) {
    if (is_motion(entry.transmit_class)) {
      give_up_motion(entry, now);
    } else {
      give_up_other(entry, now, last_sign_of_life);
    }
  }
  erase_gone();
}

void InFlight::give_up_motion(Entry& entry, TimePoint now) const {
  if (entry.overdue) {
    entry.gone = entry.lost_at && now >= *entry.lost_at;
    return;
  }
  if (now < entry.look_at) {
    return;
  }
  tell(entry.told, Departure::unknown);
  entry.look_at = entry.since + times_.echo;
  if (now >= entry.look_at) {
    entry.overdue = true;
    entry.gone = entry.passed;
  }
}

// Where nothing is received at all, the frame stays with the controller, and another one would only follow it there.
void InFlight::give_up_other(Entry& entry, TimePoint now, std::optional<TimePoint> last_sign_of_life) {
  if (now < entry.look_at) {
    return;
  }
  const bool lives = last_sign_of_life > entry.since && now - *last_sign_of_life < times_.echo;
  if (lives || now >= entry.since + kLongestWait) {
    forget(entry);
  } else {
    entry.look_at = std::min(now + times_.echo, entry.since + kLongestWait);
  }
}

TimePoint InFlight::next_time(bool motion_waits) const noexcept {
  TimePoint next = kNever;
  for (const Entry& entry : entries_) {
    next = std::min(next, entry.overdue ? entry.lost_at.value_or(kNever) : entry.look_at);
    const TimePoint stuck = entry.since + times_.behind;
    if (motion_waits && looked_ < stuck && !will_be_proven(entry.number, entry.frame.id)) {
      next = std::min(next, stuck);
    }
    const bool uncertain = is_motion(entry.transmit_class) && (entry.overdue || entry.doubtful);
    if (uncertain && forgotten_ && looked_ < forgotten_->since + times_.echo) {
      next = std::min(next, forgotten_->since + times_.echo);
    }
  }
  return next;
}

bool InFlight::leaves_room_for(TransmitClass transmit_class, const Frame& frame, TimePoint now) const noexcept {
  if (transmit_class == TransmitClass::stop) {
    // A later frame proves that one has gone before it: only its echo is missing.
    return std::none_of(entries_.begin(), entries_.end(),
                        [](const Entry& entry) { return is_motion(entry.transmit_class) && !entry.passed; });
  }
  if (is_motion(transmit_class)) {
    return !forgotten_ && std::none_of(entries_.begin(), entries_.end(), [&](const Entry& entry) {
      return is_motion(entry.transmit_class) || now - entry.since > times_.behind;
    });
  }
  return std::none_of(entries_.begin(), entries_.end(), [&](const Entry& entry) {
    return entry.transmit_class == transmit_class &&
           (entry.transmit_class == TransmitClass::sdo || entry.frame.id == frame.id);
  });
}

// A repetition whose echo is missing only holds them back: a heartbeat of ours will tell, long before a stop is late.
bool InFlight::refuses_commands() const noexcept {
  return std::any_of(entries_.begin(), entries_.end(),
                     [](const Entry& entry) { return entry.overdue && is_command(entry.transmit_class); });
}

bool InFlight::wants_proof(bool motion_waits, TimePoint now) const noexcept {
  if (motion_waits && forgotten_ && !will_be_proven(forgotten_->number, forgotten_->cob_id)) {
    return true;
  }
  return std::any_of(entries_.begin(), entries_.end(), [&](const Entry& entry) {
    const bool stuck = motion_waits && now - entry.since >= times_.behind;
    // The one that would have told is forgotten, too: another may be sent when its echo has had its time.
    const bool was_asked = forgotten_ && forgotten_->number > entry.number && now < forgotten_->since + times_.echo;
    const bool uncertain = is_motion(entry.transmit_class) && (entry.overdue || entry.doubtful) && !was_asked;
    return (stuck || uncertain) && !will_be_proven(entry.number, entry.frame.id);
  });
}

bool InFlight::proves(std::uint32_t cob_id, std::uint32_t of_earlier) const noexcept {
  return cob_id >= of_earlier || !has_heartbeat_;
}

bool InFlight::will_be_proven(std::uint64_t number, std::uint32_t cob_id) const noexcept {
  return std::any_of(entries_.begin(), entries_.end(), [&](const Entry& entry) {
    return entry.number > number && !entry.doubtful && proves(entry.frame.id, cob_id);
  });
}

void InFlight::forget(Entry& entry) {
  entry.gone = true;
  if (has_heartbeat_) {
    const std::uint32_t highest = forgotten_ ? forgotten_->cob_id : 0;
    const bool is_newest = !forgotten_ || forgotten_->number < entry.number;
    forgotten_ = {is_newest ? entry.frame : forgotten_->newest, is_newest ? entry.number : forgotten_->number,
                  std::max(highest, entry.frame.id), is_newest ? entry.since : forgotten_->since};
  }
}

void InFlight::erase_gone() {
  for (Entry& entry : entries_) {
    if (entry.gone) {
      tell(entry.told, Departure::unknown);
    }
  }
  std::erase_if(entries_, [](const Entry& entry) { return entry.gone; });
}

}  // namespace canopen
