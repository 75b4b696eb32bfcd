// What of a transfer is particular to block transfer.

#include <string>
#include <utility>

#include "canopen/sdo/abort_codes.h"
#include "canopen/sdo/block_frames.h"
#include "canopen/sdo/transfer.h"

namespace canopen {
namespace {

constexpr std::uint8_t kSizeTold = 0x02;  // Of the answer to a block upload request.

std::string too_short(std::span<const std::uint8_t> answer) {
  return "an answer of " + std::to_string(answer.size()) + " bytes is too short for block transfer";
}

}  // namespace

void SdoTransfer::use_segments() {
  if (asks_for_block()) {
    block_ = false;
    request_ = is_upload() ? upload_request(object_) : download_request(object_, data_);
  }
}

unsigned SdoTransfer::load() const noexcept {
  if (!in_block()) {
    return 2;
  }
  return block_upload_ && block_upload_->wants_segments() ? 1U + SdoBlockUpload::kSegments : 1U;
}

SdoTransfer::Step SdoTransfer::on_departure() {
  if (!in_block()) {
    return Step::ignored;
  }
  return take(block_upload_ ? block_upload_->on_departure() : block_download_->on_departure());
}

SdoTransfer::Step SdoTransfer::on_block_accepted(std::span<const std::uint8_t> answer) {
  if (answer.size() < 8) {
    return fail(too_short(answer), kAbortLengthMismatch);
  }
  // Bits 1..0 of both are 0 in the answer to the first request; the size of an upload is a hint, as in segments.
  if (block_download_answer_of(answer[0]) != BlockAnswer::initiate && !is_upload()) {
    return Step::ignored;
  }
  if (is_upload() && block_upload_answer_of(answer[0]) != BlockAnswer::initiate) {
    return Step::ignored;
  }
  phase_ = Phase::block;
  if (!is_upload()) {
    block_download_.emplace(data_, answer);
    return take(block_download_->begin());
  }
  const std::uint32_t size = (answer[0] & kSizeTold) != 0 ? decode_u32(answer.subspan(4)) : 0;
  if (size > kMaxBytes) {
    return fail(std::to_string(size) + " bytes are more than are taken", kAbortOutOfMemory);
  }
  block_upload_.emplace(answer, kMaxBytes);
  request_ = block_upload_start();
  return Step::more;
}

SdoTransfer::Step SdoTransfer::on_block(std::span<const std::uint8_t> answer) {
  if (answer.size() < 8) {
    return fail(too_short(answer), kAbortLengthMismatch);
  }
  return take(block_upload_ ? block_upload_->on_answer(answer) : block_download_->on_answer(answer));
}

SdoTransfer::Step SdoTransfer::take(SdoReaction reaction) {
  switch (reaction.step) {
    case Step::ignored:
    case Step::taken:
      break;
    case Step::more:
      request_ = reaction.request;
      break;
    case Step::completed:
      if (block_upload_) {
        data_ = block_upload_->data();
      }
      return complete();
    case Step::failed:
      return fail(std::move(reaction.why), reaction.abort_code);
  }
  return reaction.step;
}

}  // namespace canopen
