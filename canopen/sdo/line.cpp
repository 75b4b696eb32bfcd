#include "canopen/sdo/line.h"

#include <algorithm>
#include <utility>

namespace canopen {

SdoLine::SdoLine(boost::asio::any_io_executor executor, SdoBudget& budget)
    : budget_(budget), moved_(std::move(executor)) {}

void SdoLine::call_off(std::initializer_list<Kind> kinds, const Error& why) {
  for (Place* place : places_) {
    if (std::find(kinds.begin(), kinds.end(), place->kind_) != kinds.end() && !place->called_off_) {
      place->called_off_ = why;
    }
  }
  moved_.notify();
}

void SdoLine::call_off_held_command(const Error& why) {
  if (holder_ != nullptr && holder_->kind_ == Kind::command && !holder_->called_off_) {
    holder_->called_off_ = why;
  }
}

bool SdoLine::held_by_transfer() const noexcept {
  return holder_ != nullptr && holder_->kind_ == Kind::transfer;
}

boost::asio::awaitable<void> SdoLine::until_empty() {
  while (!empty()) {
    co_await moved_.wait_until(TimePoint::max());
  }
}

/// Behind those of its kind.
void SdoLine::insert(Place* place) {
  const auto first_lower =
      std::find_if(places_.begin(), places_.end(), [place](const Place* other) { return other->kind_ < place->kind_; });
  places_.insert(first_lower, place);
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

boost::asio::awaitable<bool> SdoLine::Place::wait_until(TimePoint deadline) {
  while (!line_.is_next(this) && !called_off_ && Clock::now() < deadline) {
    co_await line_.moved_.wait_until(deadline);
  }
  if (!called_off_ && !line_.is_next(this)) {
    called_off_ = Error{
        .kind = ErrorKind::timeout, .not_sent = true, .detail = "not begun: other SDO transfers held the channel"};
  }
  if (!called_off_) {
    line_.holder_ = this;
  }
  co_return !called_off_;
}

boost::asio::awaitable<bool> SdoLine::Place::step_aside(TimePoint until) {
  line_.holder_ = nullptr;
  const bool alone = Clock::now() >= until && line_.is_next(this);
  if (!alone) {
    line_.moved_.notify();
  }
  while (!called_off_ && Clock::now() < until) {
    co_await line_.moved_.wait_until(until);
  }
  static_cast<void>(co_await wait_until(TimePoint::max()));
  co_return !alone;
}

}  // namespace canopen
