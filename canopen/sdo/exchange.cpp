#include "canopen/sdo/exchange.h"

#include <algorithm>
#include <string>
#include <utility>

#include "canopen/bus/transmission.h"

namespace canopen {
Frame sdo_request_frame(std::uint8_t node, const SdoFrame& request) noexcept {
  return make_frame(kSdoRequestBase + node, request);
}

SdoExchange::SdoExchange(const Channel& channel, SdoTransfer transfer, TransmitClass transmit_class, TimePoint deadline,
                         bool late_possible)
    : channel_(channel),
      transfer_(std::move(transfer)),
      transmit_class_(transmit_class),
      deadline_(deadline),
      late_possible_(late_possible),
      ended_(channel.executor) {}

boost::asio::awaitable<void> SdoExchange::run() {
  send();
  while (!over_ && channel_.bus.may_still_hear(due_)) {
    if (Clock::now() >= next_at_) {
      send();
    } else {
      const TimePoint until = std::min(next_at_, or_soon(due_));
      co_await ended_.wait_until(until);
    }
  }
  cut_short_ = !over_ && due_ == limit_;
  request_.withdraw();  // The deadline may have come before its departure.
  if (!over_) {
    end(no_answer());
  }
}

SdoTransfer::Step SdoExchange::on_answer(std::span<const std::uint8_t> answer) {
  if (over_ || (request_.waiting() && !transfer_.in_block())) {
    return SdoTransfer::Step::ignored;  // While ours has not left it is that to another's request.
  }
  const SdoTransfer::Step step = transfer_.on_answer(answer, late_possible_);
  waits_ = waits_ && (step == SdoTransfer::Step::ignored || step == SdoTransfer::Step::taken);
  switch (step) {
    case SdoTransfer::Step::ignored:
      break;
    case SdoTransfer::Step::completed:
      end({});
      break;
    case SdoTransfer::Step::failed:
      end(transfer_.error());
      break;
    case SdoTransfer::Step::taken:
    case SdoTransfer::Step::more:
      if (withdrawn_ && transfer_.is_upload() && !transfer_.only_to_confirm()) {
        give_up();
      } else if (step == SdoTransfer::Step::more) {
        send_in_turn();
      } else {
        await_answer(Clock::now());
      }
      break;
  }
  return step;
}

void SdoExchange::give_up() {
  given_up_ = true;
  end(Error{.kind = ErrorKind::timeout, .detail = "given up for a command"});
}

void SdoExchange::interrupt(Error why) {
  if (!over_) {
    over_ = true;
    request_.withdraw();
    end(std::move(why));
  }
}

void SdoExchange::withdraw() {
  if (!over_ && (!transfer_.in_segments() || transfer_.is_upload())) {
    withdrawn_ = true;
    request_.withdraw();
    if (next_at_ != kNever) {
      give_up();
    }
  }
}

void SdoExchange::hurry(TimePoint until) {
  withdraw();
  limit_ = std::min(limit_, until);
  due_ = std::min(due_, limit_);
  ended_.notify();
}

bool SdoExchange::disturb() {
  if (over_ || request_.waiting()) {
    return false;
  }
  disturbed_ = true;
  end(Error{.kind = ErrorKind::timeout, .detail = "another SDO client asked this drive meanwhile"});
  return true;
}

void SdoExchange::send() {
  if (is_sent_once() || transfer_.in_segments()) {
    channel_.bus.sdo_budget().charge(transfer_.load());  // The first request of any other transfer was granted.
  }
  next_at_ = kNever;
  due_ = std::min(deadline_, limit_);
  departure_.reset();
  waits_ = true;
  const TimePoint until = is_sent_once() ? deadline_ : std::min(deadline_, Clock::now() + TransmitQueue::kLifeTime);
  const Frame frame = sdo_request_frame(channel_.node, transfer_.request());
  request_ = channel_.bus.send(transmit_class_, frame, until, [this](Departure how) { on_departure(how); });
}

// A sub-block of a server is many frames that go before all heartbeats. It waits for us as long as we wait for it, or
// so.
void SdoExchange::send_in_turn() {
  const TimePoint free_at = channel_.bus.sdo_budget().free_at();
  if (is_sent_once() || !transfer_.begins_sub_block() || free_at <= Clock::now()) {
    send();
    return;
  }
  next_at_ = std::min(free_at, Clock::now() + channel_.settings.timeout / 2);
  due_ = std::min(deadline_, limit_);
  ended_.notify();
}

void SdoExchange::on_departure(Departure how) {
  departure_ = how;
  if (over_) {
    return;
  }
  if (never_left()) {
    end(result_of(how).error());
    return;
  }
  // Without its echo it may have left all the same: an answer would prove it.
  left_at_ = Clock::now();
  const SdoTransfer::Step step = transfer_.on_departure();
  if (step == SdoTransfer::Step::completed) {
    waits_ = false;
    end({});
  } else if (step == SdoTransfer::Step::more) {
    next_at_ = left_at_;  // By run(): the bus must not be called from here.
  }
  await_answer(left_at_);
}

void SdoExchange::await_answer(TimePoint from) {
  due_ = std::min(deadline_, limit_);
  if (!is_sent_once()) {
    due_ = std::min(due_, from + channel_.settings.timeout);
  }
  ended_.notify();
}

Error SdoExchange::no_answer() const {
  Error error{.kind = ErrorKind::timeout, .detail = "its departure was not seen, nor an answer"};
  if (departure_) {
    const auto waited = std::chrono::duration_cast<std::chrono::milliseconds>(Clock::now() - left_at_);
    error.detail = "no answer in " + std::to_string(waited.count()) + " ms";
  }
  error.detail += cut_short_ ? ", and a stop goes first" : "";
  return error;
}

void SdoExchange::end(std::optional<Error> why) {
  over_ = true;
  error_ = std::move(why);
  if (error_) {
    error_->node = channel_.node;
    error_->object = transfer_.object();
    error_->not_sent = never_left() && !transfer_.in_segments();
  }
  ended_.notify();
}

}  // namespace canopen
