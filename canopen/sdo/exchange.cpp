#include "canopen/sdo/exchange.h"

#include <algorithm>
#include <string>
#include <utility>

#include "canopen/bus/transmission.h"

namespace canopen {
namespace {

constexpr std::uint32_t kRequestBase = 0x600;  // CiA 301 table 75, default SDO.

}  // namespace

Frame sdo_request_frame(std::uint8_t node, const SdoFrame& request) noexcept {
  return make_frame(kRequestBase + node, request);
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
  request_.withdraw();  // The deadline may have come before its departure.
  if (!over_) {
    silent_ = true;
    const auto waited = std::chrono::duration_cast<std::chrono::milliseconds>(channel_.settings.timeout);
    fail(addressed({.kind = ErrorKind::timeout, .detail = "no answer in " + std::to_string(waited.count()) + " ms"}));
  }
}

SdoTransfer::Step SdoExchange::on_answer(std::span<const std::uint8_t> answer) {
  if (request_.waiting()) {
    return SdoTransfer::Step::ignored;  // It is that to another's request: ours has not left.
  }
  const SdoTransfer::Step step = transfer_.on_answer(answer, late_possible_);
  switch (step) {
    case SdoTransfer::Step::ignored:
      break;
    case SdoTransfer::Step::more:
      send();
      break;
    case SdoTransfer::Step::completed:
      over_ = true;
      ended_.notify();
      break;
    case SdoTransfer::Step::failed:
      fail(addressed(transfer_.error()));
      break;
  }
  return step;
}

void SdoExchange::interrupt(Error why) {
  fail(std::move(why));
  request_.withdraw();
}

void SdoExchange::withdraw() {
  if (!transfer_.in_segments()) {
    request_.withdraw();
  }
}

void SdoExchange::send() {
  if (is_command() || transfer_.in_segments()) {
    channel_.bus.sdo_budget().charge();  // The first request of any other transfer was granted.
  }
  due_ = deadline_;
  departure_.reset();
  const TimePoint until = is_command() ? deadline_ : std::min(deadline_, Clock::now() + TransmitQueue::kLifeTime);
  const Frame frame = sdo_request_frame(channel_.node, transfer_.request());
  request_ = channel_.bus.send(transmit_class_, frame, until, [this](Departure how) { on_departure(how); });
}

void SdoExchange::on_departure(Departure how) {
  departure_ = how;
  if (over_) {
    return;
  }
  if (never_left()) {
    fail(addressed(result_of(how).error()));
    return;
  }
  // Without its echo it may have left all the same: an answer would prove it.
  due_ = std::min(deadline_, Clock::now() + channel_.settings.timeout);
  ended_.notify();
}

void SdoExchange::fail(Error why) {
  over_ = true;
  error_ = std::move(why);
  ended_.notify();
}

Error SdoExchange::addressed(Error error) const {
  error.node = channel_.node;
  error.object = transfer_.object();
  return error;
}

}  // namespace canopen
