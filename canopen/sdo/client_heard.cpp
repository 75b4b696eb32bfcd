// What an SDO client hears: answers of its node, wanted or not, and requests of others to it.

#include "canopen/bus/bus.h"
#include "canopen/sdo/client.h"
#include "canopen/sdo/frames.h"

namespace canopen {

void SdoClient::on_frame(const Received& received) {
  const SdoTransfer::Step step =
      exchange_ == nullptr ? SdoTransfer::Step::ignored : exchange_->on_answer(received.frame.bytes());
  answered_ = answered_ || step != SdoTransfer::Step::ignored;
  if (step == SdoTransfer::Step::ignored) {
    judge_unwanted(received);
  } else if (step == SdoTransfer::Step::completed || step == SdoTransfer::Step::failed) {
    note_answer(received.frame.bytes());
    on_end(exchange_->transfer());
  }
}

/// Only where nothing else can still be answered a further answer proves anything.
void SdoClient::note_answer(std::span<const std::uint8_t> answer) {
  if (exchange_->is_stop() || exchange_->disturbed() || exchange_->transfer().in_segments() || unanswered_.any() ||
      others_ask(Clock::now())) {
    second_.forget();
  } else {
    second_.on_answered(answer);
  }
}

bool SdoClient::others_ask(TimePoint now) const noexcept {
  constexpr int kSlowestAnswer = 4;  // In timeouts of ours; that master may be more patient.
  return foreign_at_ && now - *foreign_at_ < kSlowestAnswer * channel_.settings.timeout;
}

void SdoClient::judge_unwanted(const Received& received) const {
  const SecondAnswer::Verdict verdict = second_.judge(received.frame.bytes());
  if (verdict != SecondAnswer::Verdict::none && second_handler_ && !others_ask(received.at)) {
    second_handler_(verdict == SecondAnswer::Verdict::different);
  }
}

void SdoClient::on_foreign_request(const Received& received) {
  second_.forget();
  foreign_at_ = received.at;
  const std::span<const std::uint8_t> request = received.frame.bytes();
  if (exchange_ == nullptr || !exchange_->disturb() || request.empty()) {
    return;
  }
  const SdoRequest kind = sdo_request_of(request[0]);
  const std::optional<ObjectAddress> object = address_of(request);
  if (object && begins_transfer(kind)) {
    unanswered_.note(*object, kind == SdoRequest::upload || kind == SdoRequest::block_upload);
  }
}

void SdoClient::on_end(const SdoTransfer& transfer) {
  if (transfer.abort()) {
    send_abort(*transfer.abort());
  }
  if (transfer.error().kind == ErrorKind::refused && abort_handler_) {
    abort_handler_(transfer.error().abort);
  }
  if (!transfer.remark().empty() && remark_handler_) {
    remark_handler_(to_string(transfer.object()) + ": " + transfer.remark());
  }
}

}  // namespace canopen
