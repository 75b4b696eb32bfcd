#include "canopen/transmit_queue.h"

#include <algorithm>
#include <utility>

namespace canopen {
namespace {

void complete(TransmitQueue::Completion& completion, Departure departure) {
  if (const TransmitQueue::Completion once = std::exchange(completion, nullptr)) {
    once(departure);
  }
}

}  // namespace

TransmitQueue::TransmitQueue(Link& link) : link_(link) {
  waiting_.reserve(kCapacity);
  in_kernel_.reserve(kMaxInKernel);
}

bool TransmitQueue::push(const Frame& frame, TimePoint now) {
  return enqueue({frame, Kind::ordinary, now + kLifeTime, 0, nullptr});
}

bool TransmitQueue::push_latest(const Frame& frame, TimePoint now) {
  return replace_or_enqueue(frame, Kind::latest, now);
}

bool TransmitQueue::push_repetition(const Frame& frame, TimePoint now) {
  return replace_or_enqueue(frame, Kind::repetition, now);
}

TransmitQueue::Ticket TransmitQueue::push_command(const Frame& frame, TimePoint deadline, Completion completion,
                                                  TimePoint now) {
  const Ticket ticket = ++last_ticket_;
  if (!up_ || refuses_commands()) {
    complete(completion, Departure::offline);
    return ticket;
  }
  if (deadline <= now || waiting_.size() >= kCapacity) {
    complete(completion, Departure::withdrawn);
    return ticket;
  }
  std::erase_if(waiting_, [&](const Waiting& entry) {
    return (entry.kind == Kind::latest || entry.kind == Kind::repetition) && entry.frame.id == frame.id;
  });
  enqueue({frame, Kind::command, deadline, ticket, std::move(completion)});
  return ticket;
}

void TransmitQueue::cancel(Ticket ticket) {
  std::erase_if(waiting_, [&](const Waiting& entry) { return entry.kind == Kind::command && entry.ticket == ticket; });
  for (InKernel& entry : in_kernel_) {
    if (entry.kind == Kind::command && entry.ticket == ticket) {
      entry.completion = nullptr;
    }
  }
}

void TransmitQueue::withdraw(std::uint32_t cob_id) {
  const auto is_such = [&](const Waiting& entry) { return entry.kind != Kind::ordinary && entry.frame.id == cob_id; };
  for (Waiting& entry : waiting_) {
    if (is_such(entry)) {
      complete(entry.completion, Departure::withdrawn);
    }
  }
  std::erase_if(waiting_, is_such);
}

// The kernel gives frames back in the order it got them; a controller with several mailboxes may swap neighbours. The
// oldest frame with this content is the one. Frames before it have lost their echo (a receive overrun), or follow at
// once: none is kept in front of later ones, so that a lost echo shifts nothing.
void TransmitQueue::on_echo(const Frame& frame, TimePoint at) {
  last_sign_of_life_ = at;
  retry_at_.reset();
  const auto found =
      std::find_if(in_kernel_.begin(), in_kernel_.end(), [&](const InKernel& entry) { return entry.frame == frame; });
  const bool known = found != in_kernel_.end();
  for (auto entry = known ? found + 1 : in_kernel_.begin(); entry != in_kernel_.end(); ++entry) {
    if (entry->overdue && !entry->lost_at) {
      entry->lost_at = at + kEchoTime;
    }
  }
  if (!known) {
    return;
  }
  complete(found->completion, Departure::left);
  for (auto entry = in_kernel_.begin(); entry != found; ++entry) {
    entry->passed = true;
    entry->gone = entry->kind != Kind::command || entry->overdue;
  }
  found->gone = true;
  erase_gone();
}

void TransmitQueue::on_bus(bool up) {
  up_ = up;
  if (up) {
    return;
  }
  fail_waiting_commands();
  waiting_.clear();
  // The kernel drops what it had. But a controller may keep one frame over a bus-off: commands wait for an echo.
  std::erase_if(in_kernel_, [](const InKernel& entry) { return entry.kind != Kind::command; });
  for (InKernel& entry : in_kernel_) {
    complete(entry.completion, Departure::unknown);
    entry.overdue = true;
    entry.lost_at.reset();
  }
  last_sign_of_life_.reset();
  retry_at_.reset();
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
  TimePoint next = retry_at_.value_or(TimePoint::max());
  for (const Waiting& entry : waiting_) {
    next = std::min(next, entry.until);
  }
  for (const InKernel& entry : in_kernel_) {
    if (entry.overdue) {
      next = std::min(next, entry.lost_at.value_or(TimePoint::max()));
    } else if (entry.completion) {
      next = std::min(next, entry.until);
    } else {
      next = std::min(next, entry.since + (entry.kind == Kind::command ? kEchoTime : kLifeTime));
    }
  }
  return next == TimePoint::max() ? std::nullopt : std::optional(next);
}

bool TransmitQueue::wants_sign_of_life(TimePoint now) const noexcept {
  return up_ && in_kernel_.empty() && !waiting_.empty() && !alive(now) &&
         std::all_of(waiting_.begin(), waiting_.end(), [](const Waiting& entry) {
           return entry.kind == Kind::command || entry.kind == Kind::repetition;
         });
}

bool TransmitQueue::replace_or_enqueue(const Frame& frame, Kind kind, TimePoint now) {
  if (!up_ || holds_command(frame.id)) {
    return false;
  }
  for (Waiting& entry : waiting_) {
    if (entry.kind == kind && entry.frame.id == frame.id) {
      entry.frame = frame;
      entry.until = now + kLifeTime;
      return true;
    }
  }
  return enqueue({frame, kind, now + kLifeTime, 0, nullptr});
}

bool TransmitQueue::enqueue(Waiting entry) {
  if (!up_ || waiting_.size() >= kCapacity) {
    return false;
  }
  // Descending identifiers, and of equal ones the older further back.
  const auto place = std::lower_bound(waiting_.begin(), waiting_.end(), entry.frame.id,
                                      [](const Waiting& other, std::uint32_t id) { return other.frame.id > id; });
  waiting_.insert(place, std::move(entry));
  return true;
}

bool TransmitQueue::holds_command(std::uint32_t cob_id) const noexcept {
  const auto is_such = [&](const auto& entry) { return entry.kind == Kind::command && entry.frame.id == cob_id; };
  return std::any_of(waiting_.begin(), waiting_.end(), is_such) ||
         std::any_of(in_kernel_.begin(), in_kernel_.end(), is_such);
}

bool TransmitQueue::refuses_commands() const noexcept {
  return std::any_of(in_kernel_.begin(), in_kernel_.end(), [](const InKernel& entry) { return entry.overdue; });
}

bool TransmitQueue::alive(TimePoint now) const noexcept {
  return last_sign_of_life_ && now - *last_sign_of_life_ <= kSignOfLife;
}

bool TransmitQueue::may_go(const Waiting& entry, TimePoint now) const noexcept {
  const auto none_like_it_left = [&] {
    return std::none_of(in_kernel_.begin(), in_kernel_.end(), [&](const InKernel& other) {
      return other.kind == entry.kind && other.frame.id == entry.frame.id;
    });
  };
  switch (entry.kind) {
    case Kind::ordinary:
      return true;
    case Kind::latest:
      return none_like_it_left();
    case Kind::repetition:
      return alive(now) && none_like_it_left();
    case Kind::command:
      return alive(now) && std::none_of(in_kernel_.begin(), in_kernel_.end(),
                                        [](const InKernel& other) { return other.kind == Kind::command; });
  }
  return false;
}

void TransmitQueue::hand_over(TimePoint now) {
  while (up_ && in_kernel_.size() < kMaxInKernel) {
    const auto next =
        std::find_if(waiting_.rbegin(), waiting_.rend(), [&](const Waiting& entry) { return may_go(entry, now); });
    if (next == waiting_.rend()) {
      return;
    }
    // `down` is followed by a report of the bus' state; until then it is no different.
    if (link_.send(next->frame) != SendResult::handed_over) {
      retry_at_ = now + kRetry;
      return;
    }
    const TimePoint until = next->kind == Kind::command ? std::min(next->until, now + kEchoTime) : now + kLifeTime;
    in_kernel_.push_back({.frame = next->frame,
                          .kind = next->kind,
                          .since = now,
                          .until = until,
                          .ticket = next->ticket,
                          .completion = std::move(next->completion),
                          .lost_at = {}});
    waiting_.erase(std::next(next).base());
  }
}

void TransmitQueue::drop_late(TimePoint now) {
  for (Waiting& entry : waiting_) {
    if (now >= entry.until) {
      complete(entry.completion, Departure::withdrawn);
    }
  }
  std::erase_if(waiting_, [&](const Waiting& entry) { return now >= entry.until; });
}

void TransmitQueue::give_up_late(TimePoint now) {
  for (InKernel& entry : in_kernel_) {
    give_up(entry, now);
  }
  erase_gone();
  if (refuses_commands()) {
    fail_waiting_commands();
  }
}

void TransmitQueue::give_up(InKernel& entry, TimePoint now) {
  if (entry.kind != Kind::command) {
    entry.gone = now >= entry.until;
    return;
  }
  if (now >= entry.until) {
    complete(entry.completion, Departure::unknown);
  }
  if (entry.overdue) {
    entry.gone = entry.lost_at && now >= *entry.lost_at;
  } else if (now >= entry.since + kEchoTime) {
    entry.overdue = true;
    entry.gone = entry.passed;
  }
}

void TransmitQueue::erase_gone() {
  std::erase_if(in_kernel_, [](const InKernel& entry) { return entry.gone; });
}

void TransmitQueue::fail_waiting_commands() {
  for (Waiting& entry : waiting_) {
    complete(entry.completion, Departure::offline);
  }
  std::erase_if(waiting_, [](const Waiting& entry) { return entry.kind == Kind::command; });
}

}  // namespace canopen
