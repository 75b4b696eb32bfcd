#include "canopen/bus/transmit_queue.h"

#include <algorithm>
#include <utility>

namespace canopen {
namespace {

// One that can move a motor, SYNC, heartbeat and a guarding request, one of SDO.
constexpr std::size_t kUsuallyInKernel = 5;

void tell(TransmitQueue::Told& told, Departure departure) {
  if (const TransmitQueue::Told once = std::exchange(told, nullptr)) {
    once(departure);
  }
}

bool is_command(TransmitClass transmit_class) noexcept {
  return transmit_class == TransmitClass::nmt || transmit_class == TransmitClass::command;
}

/// What can move a motor.
bool is_motion(TransmitClass transmit_class) noexcept {
  return is_command(transmit_class) || transmit_class == TransmitClass::repetition;
}

/// By which what waits is sorted. SDO frames and repetitions keep their order: a node with a high id has its turn, too.
std::uint64_t rank(TransmitClass transmit_class, const Frame& frame) noexcept {
  const bool in_turn = transmit_class == TransmitClass::sdo || transmit_class == TransmitClass::repetition;
  const std::uint32_t id = in_turn ? 0 : frame.id;
  return std::uint64_t{static_cast<std::uint8_t>(transmit_class)} << 32U | id;
}

}  // namespace

TransmitQueue::TransmitQueue(Link& link, TransmitTimes times) : link_(link), times_(times) {
  waiting_.reserve(kCapacity);
  in_kernel_.reserve(kUsuallyInKernel);
}

Ticket TransmitQueue::push(TransmitClass transmit_class, const Frame& frame, TimePoint until, Told told,
                           TimePoint now) {
  if (!up_ || (is_command(transmit_class) && refuses_commands())) {
    tell(told, Departure::offline);
    return {};
  }
  if (until <= now || waiting_.size() >= kCapacity) {
    tell(told, Departure::withdrawn);
    return {};
  }
  const std::uint64_t id = ++last_id_;
  enqueue({frame, transmit_class, until, id, std::move(told)});
  return {*this, id};
}

bool TransmitQueue::waits(std::uint64_t id) const noexcept {
  return std::any_of(waiting_.begin(), waiting_.end(), [id](const Waiting& entry) { return entry.id == id; });
}

void TransmitQueue::drop(std::uint64_t id) {
  std::erase_if(waiting_, [id](const Waiting& entry) { return entry.id == id; });
  for (InKernel& entry : in_kernel_) {
    if (entry.id == id) {
      entry.told = nullptr;
    }
  }
}

void TransmitQueue::withdraw(std::uint64_t id) {
  for (Waiting& entry : waiting_) {
    if (entry.id == id) {
      tell(entry.told, Departure::withdrawn);
    }
  }
  std::erase_if(waiting_, [id](const Waiting& entry) { return entry.id == id; });
}

// The kernel gives frames back in the order it got them; a controller with several mailboxes may swap neighbours. The
// oldest frame with this content is the one. Frames before it have lost their echo (a receive overrun), or follow at
// once: none is kept in front of later ones, so that a lost echo shifts nothing.
void TransmitQueue::on_echo(const Frame& frame, TimePoint at) {
  last_sign_of_life_ = at;
  retry_at_.reset();
  retry_pause_ = kRetry;
  const auto found =
      std::find_if(in_kernel_.begin(), in_kernel_.end(), [&](const InKernel& entry) { return entry.frame == frame; });
  const bool known = found != in_kernel_.end();
  for (auto entry = known ? found + 1 : in_kernel_.begin(); entry != in_kernel_.end(); ++entry) {
    if (entry->overdue && !entry->lost_at) {
      entry->lost_at = at + times_.echo;
    }
  }
  if (!known) {
    return;
  }
  tell(found->told, Departure::left);
  for (auto entry = in_kernel_.begin(); entry != found; ++entry) {
    entry->passed = true;
    entry->gone = !is_command(entry->transmit_class) || entry->overdue;
    if (entry->gone) {
      tell(entry->told, Departure::unknown);
    }
  }
  found->gone = true;
  erase_gone();
}

void TransmitQueue::on_frames_lost() {
  for (InKernel& entry : in_kernel_) {
    entry.doubtful = true;
    entry.followed = false;
    if (!is_motion(entry.transmit_class)) {
      tell(entry.told, Departure::unknown);
      entry.gone = true;
    }
  }
  erase_gone();
}

void TransmitQueue::on_bus(bool up) {
  up_ = up;
  if (up) {
    return;
  }
  for (Waiting& entry : waiting_) {
    tell(entry.told, Departure::offline);
  }
  waiting_.clear();
  // The kernel drops what it had. But a controller may keep one frame over a bus-off: what moves a motor waits for an
  // echo.
  for (InKernel& entry : in_kernel_) {
    tell(entry.told, Departure::unknown);
    entry.overdue = is_motion(entry.transmit_class);
    entry.gone = !entry.overdue;
    entry.lost_at.reset();
  }
  erase_gone();
  last_sign_of_life_.reset();
  retry_at_.reset();
  retry_pause_ = kRetry;
}

void TransmitQueue::service(TimePoint now) {
  drop_late(now);
  give_up_late(now);
  if (retry_at_ && now < *retry_at_) {
    return;
  }
  retry_at_.reset();
  hand_over(now);
}

std::optional<TimePoint> TransmitQueue::next_time() const noexcept {
  TimePoint next = retry_at_.value_or(kNever);
  for (const Waiting& entry : waiting_) {
    next = std::min(next, entry.until);
  }
  const bool in_a_hurry = up_ && motion_waits();
  for (const InKernel& entry : in_kernel_) {
    next = std::min(next, entry.overdue ? entry.lost_at.value_or(kNever) : entry.look_at);
    if (in_a_hurry && !entry.followed && !entry.looked_behind) {
      next = std::min(next, entry.since + times_.behind);
    }
  }
  return next == kNever ? std::nullopt : std::optional(next);
}

bool TransmitQueue::wants_heartbeat(TimePoint now) const noexcept {
  // What goes by itself will tell as well.
  const bool others_wait = std::any_of(waiting_.begin(), waiting_.end(), [&](const Waiting& entry) {
    return !is_motion(entry.transmit_class) && may_go(entry, now);
  });
  if (!up_ || others_wait) {
    return false;
  }
  if (!alive(now)) {
    return in_kernel_.empty() && !waiting_.empty();
  }
  const bool in_a_hurry = motion_waits();
  return std::any_of(in_kernel_.begin(), in_kernel_.end(), [&](const InKernel& entry) {
    const bool stuck = in_a_hurry && now - entry.since >= times_.behind;
    const bool uncertain = is_motion(entry.transmit_class) && (entry.overdue || entry.doubtful);
    return !entry.followed && (stuck || uncertain);
  });
}

bool TransmitQueue::motion_waits() const noexcept {
  return std::any_of(waiting_.begin(), waiting_.end(),
                     [](const Waiting& entry) { return is_motion(entry.transmit_class); });
}

void TransmitQueue::enqueue(Waiting entry) {
  // Descending ranks, and of equal ones the older further back.
  const auto place = std::lower_bound(
      waiting_.begin(), waiting_.end(), rank(entry.transmit_class, entry.frame),
      [](const Waiting& other, std::uint64_t mine) { return rank(other.transmit_class, other.frame) > mine; });
  waiting_.insert(place, std::move(entry));
}

// A repetition whose echo is missing only holds them back: a heartbeat of ours will tell, long before a stop is late.
bool TransmitQueue::refuses_commands() const noexcept {
  return std::any_of(in_kernel_.begin(), in_kernel_.end(),
                     [](const InKernel& entry) { return entry.overdue && is_command(entry.transmit_class); });
}

bool TransmitQueue::alive(TimePoint now) const noexcept {
  return last_sign_of_life_ && now - *last_sign_of_life_ <= kSignOfLife;
}

bool TransmitQueue::may_go(const Waiting& waiting, TimePoint now) const noexcept {
  if (is_motion(waiting.transmit_class)) {
    return alive(now) && std::none_of(in_kernel_.begin(), in_kernel_.end(), [&](const InKernel& entry) {
             return is_motion(entry.transmit_class) || now - entry.since > times_.behind;
           });
  }
  return std::none_of(in_kernel_.begin(), in_kernel_.end(), [&](const InKernel& entry) {
    return entry.transmit_class == waiting.transmit_class &&
           (entry.transmit_class == TransmitClass::sdo || entry.frame.id == waiting.frame.id);
  });
}

void TransmitQueue::hand_over(TimePoint now) {
  while (up_) {
    const auto next =
        std::find_if(waiting_.rbegin(), waiting_.rend(), [&](const Waiting& entry) { return may_go(entry, now); });
    if (next == waiting_.rend()) {
      return;
    }
    // `down` is followed by a report of the bus' state; until then it is no different.
    if (link_.send(next->frame) != SendResult::handed_over) {
      retry_at_ = now + retry_pause_;
      retry_pause_ = std::min(2 * retry_pause_, kLongestRetry);
      return;
    }
    retry_pause_ = kRetry;
    for (InKernel& before : in_kernel_) {
      before.followed = true;
    }
    const TimePoint look_at =
        is_command(next->transmit_class) ? std::min(next->until, now + times_.echo) : now + times_.echo;
    in_kernel_.push_back({.frame = next->frame,
                          .transmit_class = next->transmit_class,
                          .since = now,
                          .look_at = look_at,
                          .id = next->id,
                          .told = std::move(next->told),
                          .lost_at = {}});
    waiting_.erase(std::next(next).base());
  }
}

void TransmitQueue::drop_late(TimePoint now) {
  for (Waiting& entry : waiting_) {
    if (now >= entry.until) {
      tell(entry.told, Departure::withdrawn);
    }
  }
  std::erase_if(waiting_, [&](const Waiting& entry) { return now >= entry.until; });
}

void TransmitQueue::give_up_late(TimePoint now) {
  const bool any_late = std::any_of(in_kernel_.begin(), in_kernel_.end(), [now](const InKernel& entry) {
    return now >= (entry.overdue ? entry.lost_at.value_or(kNever) : entry.look_at);
  });
  if (any_late) {
    now = std::min(now, link_.heard_until());  // After a stall the echo may lie in the socket.
  }
  for (InKernel& entry : in_kernel_) {
    entry.looked_behind = entry.looked_behind || now - entry.since >= times_.behind;
    if (is_motion(entry.transmit_class)) {
      give_up_motion(entry, now);
    } else {
      give_up_other(entry, now);
    }
  }
  erase_gone();
  if (refuses_commands()) {
    fail_waiting_commands();
  }
}

void TransmitQueue::give_up_motion(InKernel& entry, TimePoint now) const {
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
void TransmitQueue::give_up_other(InKernel& entry, TimePoint now) const {
  if (now < entry.look_at) {
    return;
  }
  const bool lives = last_sign_of_life_ && *last_sign_of_life_ > entry.since && now - *last_sign_of_life_ < times_.echo;
  if (lives || now >= entry.since + kLifeTime) {
    tell(entry.told, Departure::unknown);
    entry.gone = true;
  } else {
    entry.look_at = std::min(now + times_.echo, entry.since + kLifeTime);
  }
}

void TransmitQueue::erase_gone() {
  std::erase_if(in_kernel_, [](const InKernel& entry) { return entry.gone; });
}

void TransmitQueue::fail_waiting_commands() {
  for (Waiting& entry : waiting_) {
    if (is_command(entry.transmit_class)) {
      tell(entry.told, Departure::offline);
    }
  }
  std::erase_if(waiting_, [](const Waiting& entry) { return is_command(entry.transmit_class); });
}

}  // namespace canopen
