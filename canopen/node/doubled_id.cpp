#include "canopen/node/doubled_id.h"

#include <algorithm>
#include <utility>

namespace canopen {
namespace {

// A node takes this long at most to reset (CiA 301 sets no limit): a boot-up within it may be the answer to a command.
constexpr Duration kResetTime = std::chrono::seconds(10);
// CAN sends a frame once more at once where its last bit was disturbed: such a pair is one boot-up.
constexpr Duration kOneFrame = std::chrono::milliseconds(20);

std::string went_back_text(NmtState state, NmtState other) {
  return "its heartbeat goes from " + std::string(name_of(state)) + " to " + std::string(name_of(other)) +
         " and back within two periods, and nobody commanded it";
}

}  // namespace

void RateCheck::set_period(Duration period) noexcept {
  period_ = period;
  begin_anew();
}

bool RateCheck::hear(TimePoint at) noexcept {
  times_[count_ % times_.size()] = at;
  ++count_;
  if (period_ <= Duration::zero() || count_ < times_.size()) {
    return false;
  }
  // One sender takes 15 periods, two take half of that; the border lies at 8.6.
  const Duration took = at - times_[count_ % times_.size()];
  return took * 7 <= period_ * static_cast<int>(kIntervals) * 4;
}

void DoubledId::on_heartbeat(NmtState state, TimePoint at) {
  if (rate_.hear(at)) {
    hint(at, "its heartbeats come twice as often as they should");
  }
  if (before_[0] && before_[0]->state == state) {
    before_[0]->at = at;
    return;
  }
  const std::optional<State> left = std::exchange(before_[1], std::exchange(before_[0], State{state, at}));
  // before_[1] is where it was until now, `left` where it was before that.
  const bool back = left && left->state == state && at - left->at <= 2 * period_;
  if (period_ > Duration::zero() && back && !commanded_since(left->at - period_)) {
    std::string text = went_back_text(state, before_[1]->state);
    self_starting_ ? hint(at, std::move(text)) : prove(at, std::move(text));
  }
}

void DoubledId::on_boot_up(TimePoint at) {
  const bool reset = reset_at_ && *reset_at_ >= at - kResetTime;
  const bool second = boot_up_at_ && at - *boot_up_at_ > kOneFrame && at - *boot_up_at_ <= period_;
  if (second && !reset) {
    prove(at, "two boot-ups within one heartbeat period, and nobody reset it");
  }
  boot_up_at_ = at;
  before_ = {};
  set_rate(Duration::zero());  // Until it is read anew.
}

void DoubledId::on_nmt(NmtCommand command, TimePoint at) {
  nmt_at_ = at;
  if (command == NmtCommand::reset_node || command == NmtCommand::reset_communication) {
    reset_at_ = at;
  }
}

void DoubledId::on_second_answer(bool different, TimePoint at) {
  if (different) {
    prove(at, "two different SDO answers came to one request");
  } else if (const auto before = std::exchange(further_answer_at_, at); before && at - *before < kForgotten) {
    hint(at, "SDO answers come twice");
  }
}

void DoubledId::on_doubled_tpdo(std::uint16_t number, TimePoint at) {
  hint(at, "TPDO " + std::to_string(number) + " comes twice as often as it should");
}

void DoubledId::end() noexcept {
  proof_.reset();
  hint_.reset();
  further_answer_at_.reset();
  on_frames_lost();
}

void DoubledId::on_frames_lost() noexcept {
  before_ = {};
  boot_up_at_.reset();
  rate_.begin_anew();
}

void DoubledId::look(TimePoint now) {
  for (std::optional<Sign>* sign : {&proof_, &hint_}) {
    if (*sign && now - (*sign)->last >= kForgotten) {
      sign->reset();
    }
  }
}

Doubled DoubledId::verdict() const noexcept {
  if (proof_) {
    return Doubled::proof;
  }
  return hint_ ? Doubled::hint : Doubled::no;
}

const std::string& DoubledId::text() const noexcept {
  static const std::string nothing;
  if (proof_) {
    return proof_->text;
  }
  return hint_ ? hint_->text : nothing;
}

TimePoint DoubledId::next() const noexcept {
  TimePoint next = kNever;
  for (const std::optional<Sign>* sign : {&proof_, &hint_}) {
    if (*sign) {
      next = std::min(next, (*sign)->last + kForgotten);
    }
  }
  return next;
}

// The first text stays: an alarm that says another thing each second tells nobody anything.
void DoubledId::prove(TimePoint at, std::string text) {
  if (proof_) {
    proof_->last = at;
  } else {
    proof_ = Sign{.last = at, .text = std::move(text)};
  }
}

void DoubledId::hint(TimePoint at, std::string text) {
  if (proof_) {
    proof_->last = at;
  }
  if (hint_) {
    hint_->last = at;
  } else {
    hint_ = Sign{.last = at, .text = std::move(text)};
  }
}

}  // namespace canopen
