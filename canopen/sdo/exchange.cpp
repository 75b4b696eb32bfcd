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
    co_await ended_.wait_until(or_soon(due_));
  }
  cut_short_ = !over_ && due_ == limit_;
  request_.withdraw();  // The deadline may have come before its departure.
  if (!over_) {
    end(no_answer());
  }
}

SdoTransfer::Step SdoExchange::on_answer(std::span<const std::uint8_t> answer) {
  if (over_ || request_.waiting()) {
    return SdoTransfer::Step::ignored;  // While ours has not left it is that to another's request.
  }
  const SdoTransfer::Step step = transfer_.on_answer(answer, late_possible_);
  waits_ = waits_ && step == SdoTransfer::Step::ignored;
  if (step == SdoTransfer::Step::completed) {
    end({});
  } else if (step == SdoTransfer::Step::failed) {
    end(transfer_.error());
  } else if (step == SdoTransfer::Step::more && withdrawn_ && transfer_.is_upload()) {
    end(Error{.kind = ErrorKind::timeout, .detail = "given up for a command"});
  } else if (step == SdoTransfer::Step::more) {
    send();
  }
  return step;
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
    channel_.bus.sdo_budget().charge();  // The first request of any other transfer was granted.
  }
  due_ = std::min(deadline_, limit_);
  departure_.reset();
  waits_ = true;
  const TimePoint until = is_sent_once() ? deadline_ : std::min(deadline_, Clock::now() + TransmitQueue::kLifeTime);
  const Frame frame = sdo_request_frame(channel_.node, transfer_.request());
  request_ = channel_.bus.send(transmit_class_, frame, until, [this](Departure how) { on_departure(how); });
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
  due_ = std::min(deadline_, limit_);
  if (!is_sent_once()) {
    due_ = std::min(due_, left_at_ + channel_.settings.timeout);
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
