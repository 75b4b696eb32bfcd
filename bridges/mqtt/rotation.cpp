#include "bridges/mqtt/rotation.h"

#include <algorithm>
#include <utility>

namespace mqtt {

Rotation::Rotation(std::size_t brokers, const Pauses& pauses, std::uint32_t seed)
    : pauses_(pauses), places_(brokers), random_(seed) {}

Rotation::Milliseconds Rotation::next(Outcome outcome, TimePoint now) {
  brief_ = outcome == Outcome::brief ? brief_ + 1 : 0;
  if (outcome != Outcome::none && outcome != Outcome::refused) {
    forget_round();
    rounds_ = 0;
  }
  switch (outcome) {
    case Outcome::refused:
      places_[at_].barred_until = now + pauses_.barred;
      return go_on(now);
    case Outcome::none:
      return go_on(now);
    case Outcome::silent:
      step_ = 0;
      return go_on(now);
    case Outcome::broke:
      step_ = 0;
      left_.reset();
      return breaks_often(now) ? go_on(now) : next_pause();
    case Outcome::brief:
      return breaks_often(now) || brief_ >= kBrief ? go_on(now) : next_pause();
    case Outcome::taken_over:
      return pauses_.barred;
    case Outcome::left:
      left_ = std::exchange(at_, 0);
      ends_.clear();
      return Milliseconds(0);
  }
  return next_pause();
}

bool Rotation::breaks_often(TimePoint now) {
  ends_.push_back(now);
  while (now - ends_.front() > kEndsWithin) {
    ends_.pop_front();
  }
  return ends_.size() >= kEnds && places_.size() > 1;
}

Rotation::Milliseconds Rotation::go_on(TimePoint now) {
  brief_ = 0;
  ends_.clear();
  places_[at_].tried = true;
  if (const auto left = std::exchange(left_, std::nullopt)) {
    at_ = *left;
    return Milliseconds(0);
  }
  for (std::size_t i = 1; i < places_.size(); ++i) {
    const std::size_t other = (at_ + i) % places_.size();
    if (!places_[other].tried && places_[other].barred_until <= now) {
      at_ = other;
      return Milliseconds(0);
    }
  }
  return begin_round(now);
}

Rotation::Milliseconds Rotation::begin_round(TimePoint now) {
  forget_round();
  ++rounds_;
  const auto soonest = std::min_element(places_.begin(), places_.end(), [](const Place& one, const Place& other) {
    return one.barred_until < other.barred_until;
  });
  Milliseconds pause = std::chrono::ceil<Milliseconds>(soonest->barred_until - now);
  if (pause <= Milliseconds(0) || places_.size() > 1) {
    pause = std::max(pause, next_pause());
  }
  // Those whose time is over by then, in order.
  const auto first =
      std::find_if(places_.begin(), places_.end(), [&](const Place& each) { return each.barred_until <= now + pause; });
  at_ = static_cast<std::size_t>(first - places_.begin());
  return pause;
}

Rotation::Milliseconds Rotation::next_pause() {
  constexpr unsigned kMaxStep = 20;
  const Milliseconds whole = std::min(Milliseconds(pauses_.first * (1LL << step_)), pauses_.longest);
  step_ = std::min(step_ + 1, kMaxStep);
  std::uniform_int_distribution<Milliseconds::rep> shorten(0, whole.count() / 2);
  return whole - Milliseconds(shorten(random_));
}

void Rotation::forget_round() {
  for (Place& place : places_) {
    place.tried = false;
  }
}

}  // namespace mqtt
