#include "canopen/node/nmt_expectation.h"

#include <utility>

namespace canopen {

void NmtExpectation::begin_anew() noexcept {
  wish_ = Wish::none;
  operational_ = false;
  settled_at_ = TimePoint{};
}

void NmtExpectation::give(NmtCommand command, TimePoint until) noexcept {
  if (command == NmtCommand::stop || command == NmtCommand::pre_operational) {
    wish_ = wish_ == Wish::left ? Wish::left : Wish::held;
    settled_at_ = until + settling_;
  }
}

void NmtExpectation::leave(NmtCommand command, TimePoint now) noexcept {
  settled_at_ = now + settling_;
  switch (command) {
    case NmtCommand::start:
      wish_ = Wish::operational;
      break;
    case NmtCommand::stop:
    case NmtCommand::pre_operational:
      wish_ = wish_ == Wish::left ? Wish::left : Wish::held;
      break;
    case NmtCommand::reset_node:
    case NmtCommand::reset_communication:
      wish_ = Wish::anew;
      break;
  }
}

void NmtExpectation::give_for_configuration(TimePoint until) noexcept {
  wish_ = Wish::anew;
  settled_at_ = until + settling_;
}

void NmtExpectation::release() noexcept {
  wish_ = Wish::none;
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
  if (wish_ == Wish::operational) {
    return StateMeaning::usual;
  }
  if (wish_ == Wish::held && was_operational && at < settled_at_) {
    return StateMeaning::usual;  // The stop may still be on its way.
  }
  wish_ = Wish::operational;
  return StateMeaning::started;
}

StateMeaning NmtExpectation::hear_other(TimePoint at) noexcept {
  operational_ = false;
  if (wish_ == Wish::anew) {
    wish_ = Wish::none;  // That was the reset, whether or not a boot-up message told of it.
  }
  if (wish_ != Wish::operational || at < settled_at_) {
    return StateMeaning::usual;
  }
  wish_ = Wish::left;
  return StateMeaning::left;
}

}  // namespace canopen
