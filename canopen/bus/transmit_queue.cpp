#include "canopen/bus/transmit_queue.h"

#include <algorithm>
#include <utility>

namespace canopen {
namespace {

/// By which what waits is sorted. Stops, SDO frames and repetitions keep their order: a node with a high id has its
/// turn, too.
std::uint64_t rank(const Outgoing& outgoing) noexcept {
  const TransmitClass of = outgoing.transmit_class;
  const bool in_turn = of == TransmitClass::stop || of == TransmitClass::sdo || of == TransmitClass::repetition;
  return std::uint64_t{static_cast<std::uint8_t>(of)} << 32U | (in_turn ? 0 : outgoing.frame.id);
}

/// What an unproven command before it keeps out. A stop waits for that proof instead.
bool is_refusable(TransmitClass transmit_class) noexcept {
  return is_command(transmit_class) && transmit_class != TransmitClass::stop;
}

}  // namespace

TransmitQueue::TransmitQueue(Link& link, TransmitTimes times, bool has_heartbeat)
    : link_(link), in_flight_(times, has_heartbeat) {
  waiting_.reserve(kCapacity);
}

Ticket TransmitQueue::push(TransmitClass transmit_class, const Frame& frame, TimePoint until, Told told,
                           TimePoint now) {
  if (!up_ || (is_refusable(transmit_class) && in_flight_.refuses_commands())) {
    tell(told, Departure::offline);
    return {};
  }
  if (until <= now || !make_room(transmit_class)) {
    tell(told, Departure::withdrawn);
    return {};
  }
  Outgoing pushed{frame, transmit_class, until, ++last_id_, std::move(told)};
  // Descending ranks, and of equal ones the older further back.
  const auto place = std::lower_bound(waiting_.begin(), waiting_.end(), rank(pushed),
                                      [](const Outgoing& other, std::uint64_t mine) { return rank(other) > mine; });
  waiting_.insert(place, std::move(pushed));
  return {*this, last_id_};
}

bool TransmitQueue::make_room(TransmitClass for_class) {
  if (waiting_.size() < kCapacity) {
    return true;
  }
  Outgoing& last = waiting_.front();
  if (for_class != TransmitClass::stop || last.transmit_class == TransmitClass::stop) {
    return false;
  }
  tell(last.told, Departure::withdrawn);
  waiting_.erase(waiting_.begin());
  return true;
}

bool TransmitQueue::waits(std::uint64_t id) const noexcept {
  return std::any_of(waiting_.begin(), waiting_.end(), [id](const Outgoing& entry) { return entry.id == id; });
}

void TransmitQueue::drop(std::uint64_t id) {
  std::erase_if(waiting_, [id](const Outgoing& entry) { return entry.id == id; });
  in_flight_.forget_told(id);
}

void TransmitQueue::withdraw(std::uint64_t id) {
  drop_waiting([id](const Outgoing& entry) { return entry.id == id; }, Departure::withdrawn);
}

template <class Which>
void TransmitQueue::drop_waiting(Which which, Departure departure) {
  for (Outgoing& entry : waiting_) {
    if (which(entry)) {
      tell(entry.told, departure);
    }
  }
  std::erase_if(waiting_, which);
}

void TransmitQueue::on_echo(const Frame& frame, TimePoint at) {
  on_received(at);
  forget_unsent();
  retry_at_.reset();
  retry_pause_ = kRetry;
  in_flight_.on_echo(frame, at);
}

void TransmitQueue::on_frames_lost() {
  forget_unsent();
  in_flight_.on_frames_lost();
}

void TransmitQueue::on_bus(bool up) {
  up_ = up;
  forget_unsent();
  if (up) {
    return;
  }
  drop_waiting([](const Outgoing&) { return true; }, Departure::offline);
  in_flight_.on_down();
  last_sign_of_life_.reset();
  retry_at_.reset();
  retry_pause_ = kRetry;
}

void TransmitQueue::service(TimePoint now) {
  drop_waiting([now](const Outgoing& entry) { return now >= entry.until; }, Departure::withdrawn);
  if (waiting_.empty() && !unsent_taken_) {
    forget_unsent();  // What the link did not take was withdrawn, and nothing else is to leave.
  }
  // After a stall the echo of what is late may lie in the socket.
  in_flight_.give_up_late(in_flight_.any_late(now) ? std::min(now, link_.heard_until()) : now, last_sign_of_life_);
  if (in_flight_.refuses_commands()) {
    drop_waiting([](const Outgoing& entry) { return is_refusable(entry.transmit_class); }, Departure::offline);
  }
  if (retry_at_ && now < *retry_at_) {
    return;
  }
  retry_at_.reset();
  hand_over(now);
}

void TransmitQueue::forget_unsent() noexcept {
  unsent_since_.reset();
  unsent_taken_ = false;
}

std::optional<TimePoint> TransmitQueue::next_time() const noexcept {
  TimePoint next = std::min(retry_at_.value_or(kNever), in_flight_.next_time(up_ && motion_waits()));
  for (const Outgoing& entry : waiting_) {
    next = std::min(next, entry.until);
  }
  return next == kNever ? std::nullopt : std::optional(next);
}

bool TransmitQueue::wants_heartbeat(TimePoint now) const noexcept {
  // What goes by itself will tell as well. Control that may not go, as a heartbeat behind its like, does so soon.
  const bool others_wait = std::any_of(waiting_.begin(), waiting_.end(), [&](const Outgoing& entry) {
    return entry.transmit_class == TransmitClass::control ||
           (entry.transmit_class == TransmitClass::sdo && may_go(entry, now));
  });
  if (!up_ || others_wait) {
    return false;
  }
  return alive(now) ? in_flight_.wants_proof(motion_waits(), now) : in_flight_.empty() && !waiting_.empty();
}

bool TransmitQueue::motion_waits() const noexcept {
  return std::any_of(waiting_.begin(), waiting_.end(),
                     [](const Outgoing& entry) { return is_motion(entry.transmit_class); });
}

bool TransmitQueue::alive(TimePoint now) const noexcept {
  return last_sign_of_life_ && now - *last_sign_of_life_ <= kSignOfLife;
}

bool TransmitQueue::may_go(const Outgoing& entry, TimePoint now) const noexcept {
  // A stop that leaves when the cable is plugged in moves nothing.
  const bool needs_life = is_motion(entry.transmit_class) && entry.transmit_class != TransmitClass::stop;
  return (alive(now) || !needs_life) && in_flight_.leaves_room_for(entry.transmit_class, entry.frame, now);
}

void TransmitQueue::hand_over(TimePoint now) {
  while (up_) {
    const auto next =
        std::find_if(waiting_.rbegin(), waiting_.rend(), [&](const Outgoing& entry) { return may_go(entry, now); });
    if (next == waiting_.rend()) {
      return;
    }
    unsent_since_ = unsent_since_.value_or(now);
    // `down` is followed by a report of the bus' state; until then it is no different.
    if (link_.send(next->frame) != SendResult::handed_over) {
      retry_at_ = now + retry_pause_;
      retry_pause_ = std::min(2 * retry_pause_, kLongestRetry);
      return;
    }
    retry_pause_ = kRetry;
    unsent_taken_ = true;
    in_flight_.add(std::move(*next), now);
    waiting_.erase(std::next(next).base());
  }
}

}  // namespace canopen
