#include "canopen/sdo/line.h"

#include <algorithm>
#include <utility>

namespace canopen {

SdoLine::SdoLine(boost::asio::any_io_executor executor, SdoBudget& budget)
    : budget_(budget), moved_(std::move(executor)) {}

void SdoLine::interrupt() {
  for (Place* place : places_) {
    place->verdict_ = Verdict::interrupted;
  }
  moved_.notify();
}

void SdoLine::withdraw_commands() {
  for (Place* place : places_) {
    if (place->kind_ == Kind::command && place->verdict_ == Verdict::mine) {
      place->verdict_ = Verdict::withdrawn;
    }
  }
  moved_.notify();
}

bool SdoLine::held_by_transfer() const noexcept {
  return holder_ != nullptr && holder_->kind_ == Kind::transfer;
}

boost::asio::awaitable<void> SdoLine::until_empty() {
  while (!empty()) {
    co_await moved_.wait_until(TimePoint::max());
  }
}

/// A command behind the other commands, everything else at the end.
void SdoLine::insert(Place* place) {
  if (place->kind_ == Kind::transfer) {
    places_.push_back(place);
    return;
  }
  const auto first_transfer =
      std::find_if(places_.begin(), places_.end(), [](const Place* other) { return other->kind_ == Kind::transfer; });
  places_.insert(first_transfer, place);
}

bool SdoLine::is_next(const Place* place) const noexcept {
  const auto next = std::find_if(places_.begin(), places_.end(), [](const Place* other) { return other->may_go(); });
  return holder_ == nullptr && next != places_.end() && *next == place;
}

SdoLine::Place::Place(SdoLine& line, Kind kind, TimePoint due) : line_(line), kind_(kind) {
  if (kind == Kind::transfer) {
    claim_.emplace(line.budget_, due, [&line] { line.moved_.notify(); });
  }
  line_.insert(this);
}

SdoLine::Place::~Place() {
  std::erase(line_.places_, this);
  if (line_.holder_ == this) {
    line_.holder_ = nullptr;
  }
  line_.moved_.notify();
}

boost::asio::awaitable<SdoLine::Verdict> SdoLine::Place::wait_until(TimePoint deadline) {
  while (!line_.is_next(this) && verdict_ == Verdict::mine && Clock::now() < deadline) {
    co_await line_.moved_.wait_until(deadline);
  }
  if (verdict_ != Verdict::mine) {
    co_return verdict_;
  }
  if (!line_.is_next(this)) {
    co_return Verdict::late;
  }
  line_.holder_ = this;
  ++line_.turns_;
  co_return Verdict::mine;
}

boost::asio::awaitable<bool> SdoLine::Place::step_aside(TimePoint until) {
  const std::uint64_t turns = line_.turns_;
  line_.holder_ = nullptr;
  line_.moved_.notify();
  while (verdict_ == Verdict::mine && Clock::now() < until) {
    co_await line_.moved_.wait_until(until);
  }
  static_cast<void>(co_await wait_until(TimePoint::max()));
  co_return line_.turns_ != turns + 1;
}

}  // namespace canopen
