#include "canopen/sdo/line.h"

#include <algorithm>
#include <utility>

namespace canopen {

SdoLine::SdoLine(boost::asio::any_io_executor executor) : moved_(std::move(executor)) {}

void SdoLine::interrupt() {
  ++interruptions_;
  moved_.notify();
}

void SdoLine::withdraw_commands() {
  ++withdrawals_;
  moved_.notify();
}

boost::asio::awaitable<void> SdoLine::until_empty() {
  while (!empty()) {
    co_await moved_.wait_until(TimePoint::max());
  }
}

/// A command behind the other commands, everything else at the end. The first place is taken: a transfer under way is
/// not broken off.
void SdoLine::insert(Place* place) {
  if (place->kind_ == Kind::transfer || places_.empty()) {
    places_.push_back(place);
    return;
  }
  const auto first_transfer = std::find_if(places_.begin() + 1, places_.end(),
                                           [](const Place* other) { return other->kind_ == Kind::transfer; });
  places_.insert(first_transfer, place);
}

SdoLine::Place::Place(SdoLine& line, Kind kind)
    : line_(line), kind_(kind), interruptions_(line.interruptions_), withdrawals_(line.withdrawals_) {
  line_.insert(this);
}

SdoLine::Place::~Place() {
  std::erase(line_.places_, this);
  line_.moved_.notify();
}

boost::asio::awaitable<SdoLine::Verdict> SdoLine::Place::wait_until(TimePoint deadline) {
  while (line_.places_.front() != this && verdict() == Verdict::mine && Clock::now() < deadline) {
    co_await line_.moved_.wait_until(deadline);
  }
  if (verdict() != Verdict::mine) {
    co_return verdict();
  }
  co_return line_.places_.front() == this ? Verdict::mine : Verdict::late;
}

bool SdoLine::Place::give_way() {
  const auto behind = std::find_if(line_.places_.begin() + 1, line_.places_.end(),
                                   [](const Place* other) { return other->kind_ == Kind::transfer; });
  if (behind == line_.places_.begin() + 1) {
    return false;
  }
  std::rotate(line_.places_.begin(), line_.places_.begin() + 1, behind);
  line_.moved_.notify();
  return true;
}

SdoLine::Verdict SdoLine::Place::verdict() const noexcept {
  if (interruptions_ != line_.interruptions_) {
    return Verdict::interrupted;
  }
  return kind_ == Kind::command && withdrawals_ != line_.withdrawals_ ? Verdict::withdrawn : Verdict::mine;
}

}  // namespace canopen
