#include "canopen/node/nmt_expectation.h"

#include <utility>

namespace canopen {

void NmtExpectation::begin_anew() noexcept {
  *this = NmtExpectation(settling_);
}

void NmtExpectation::give(NmtCommand command, TimePoint until) noexcept {
  if (command == NmtCommand::stop || command == NmtCommand::pre_operational) {
    wish_ = Wish::held;
    settled_at_ = until + settling_;
  }
}

void NmtExpectation::leave(NmtCommand command, TimePoint now) noexcept {
  settled_at_ = now + settling_;
  switch (command) {
    case NmtCommand::start:
      wish_ = Wish::operational;
      left_ = false;
      operational_ = true;  // What it tells next may be from before a stop that follows.
      ignore_until_ = {};
      break;
    case NmtCommand::stop:
    case NmtCommand::pre_operational:
      wish_ = Wish::held;
      break;
    case NmtCommand::reset_node:
    case NmtCommand::reset_communication:
      wish_ = Wish::none;
      left_ = false;
      ignore_until_ = settled_at_;
      break;
  }
}

void NmtExpectation::begin_boot() noexcept {
  if (wish_ == Wish::operational) {
    wish_ = Wish::none;
  }
}

void NmtExpectation::interrupt_for_boot(TimePoint until) noexcept {
  settled_at_ = until + settling_;
  ignore_until_ = settled_at_;
}

void NmtExpectation::want_start() noexcept {
  if (!may_start()) {
    wish_ = Wish::none;
    left_ = false;
  }
}

StateMeaning NmtExpectation::hear(NmtState state, TimePoint at) noexcept {
  if (state == NmtState::unknown) {
    return StateMeaning::usual;
  }
  return state == NmtState::operational ? hear_operational(at) : hear_other(at);
}

StateMeaning NmtExpectation::hear_operational(TimePoint at) noexcept {
  if (from_before(at)) {
    return StateMeaning::from_before;
  }
  const bool was_operational = std::exchange(operational_, true);
  const bool may_cross_a_stop = wish_ == Wish::held && was_operational && at < settled_at_;
  if (wish_ == Wish::operational || may_cross_a_stop) {
    return StateMeaning::usual;
  }
  wish_ = Wish::operational;
  return std::exchange(left_, false) ? StateMeaning::started_again : StateMeaning::started;
}

StateMeaning NmtExpectation::hear_other(TimePoint at) noexcept {
  operational_ = false;
  ignore_until_ = {};
  if (wish_ != Wish::operational || at < settled_at_) {
    return StateMeaning::usual;
  }
  wish_ = Wish::none;
  left_ = true;
  return StateMeaning::left;
}

}  // namespace canopen
