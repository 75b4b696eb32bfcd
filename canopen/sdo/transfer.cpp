#include "canopen/sdo/transfer.h"

#include <algorithm>
#include <utility>

#include "canopen/hex.h"
#include "canopen/sdo/abort_codes.h"
#include "canopen/sdo/block_frames.h"

namespace canopen {
namespace {

constexpr std::uint8_t kAbortByte = 0x80;

std::string answer_text(std::span<const std::uint8_t> answer) {
  return "answer 0x" + hex(answer[0], 2) + " of " + std::to_string(answer.size()) + " bytes";
}

std::string too_short(std::span<const std::uint8_t> answer, const SdoSettings& settings) {
  const std::string text = answer_text(answer) + " is too short";
  return settings.accept_short_answers ? text : text + " (sdo quirk accept_short_answers is off)";
}

// What an abort of the first request of a block transfer says where it is not the object that is refused.
bool refuses_block(std::uint32_t abort) noexcept {
  return abort == kAbortCommandUnknown || abort == 0;
}

}  // namespace

SdoTransfer SdoTransfer::upload(const SdoSettings& settings, ObjectAddress object, std::size_t expected) {
  SdoTransfer transfer(settings, object, Direction::upload, upload_request(object));
  transfer.expected_ = expected;
  if (settings.block && (expected == 0 || expected > kBlockWorthFrom)) {
    transfer.block_ = true;
    transfer.request_ = block_upload_request(object, SdoBlockUpload::kSegments, kBlockWorthFrom);
  }
  return transfer;
}

SdoTransfer SdoTransfer::download(const SdoSettings& settings, ObjectAddress object,
                                  std::span<const std::uint8_t> data) {
  SdoTransfer transfer(settings, object, Direction::download, download_request(object, data));
  transfer.data_.assign(data.begin(), data.end());
  if (settings.block && data.size() > kBlockWorthFrom) {
    transfer.block_ = true;
    transfer.request_ = block_download_request(object, static_cast<std::uint32_t>(data.size()));
  }
  return transfer;
}

SdoTransfer::Step SdoTransfer::on_answer(std::span<const std::uint8_t> answer, bool late_possible) {
  if (answer.empty() || phase_ == Phase::over) {
    return Step::ignored;
  }
  // The segments of a block upload have any other first byte; those of one that was given up may come late.
  const bool segments_may_come = late_possible || (block_upload_ && block_upload_->wants_segments());
  const bool is_abort = segments_may_come ? answer[0] == kAbortByte : sdo_answer_of(answer[0]) == SdoAnswer::abort;
  if (in_block() && !is_abort) {
    return on_block(answer);
  }
  if (is_abort) {
    return on_abort(answer, late_possible && phase_ == Phase::initiate);
  }
  return phase_ == Phase::initiate ? on_initiate(answer, late_possible) : on_segment(answer);
}

SdoTransfer::Step SdoTransfer::on_abort(std::span<const std::uint8_t> answer, bool late_possible) {
  const std::optional<ObjectAddress> address = address_of(answer);
  if (address ? *address != object_ : late_possible) {
    return Step::ignored;
  }
  const std::uint32_t code = answer.size() >= 8 ? decode_u32(answer.subspan(4)) : 0;
  if (asks_for_block() && refuses_block(code)) {
    block_refused_ = true;
    use_segments();
    return Step::more;
  }
  phase_ = Phase::over;
  error_.kind = ErrorKind::refused;
  if (answer.size() >= 8) {
    error_.abort = code;
  } else {
    error_.detail = "abort, code missing";
  }
  return Step::failed;
}

SdoTransfer::Step SdoTransfer::on_initiate(std::span<const std::uint8_t> answer, bool late_possible) {
  const SdoAnswer kind = sdo_answer_of(answer[0]);
  // A segment carries no address; here it can only be a late one of an earlier transfer.
  if (kind == SdoAnswer::upload_segment || kind == SdoAnswer::download_segment || address_of(answer) != object_) {
    return Step::ignored;
  }
  if (block_ && kind == (is_upload() ? SdoAnswer::block_upload : SdoAnswer::block_download)) {
    return on_block_accepted(answer);
  }
  // A server may answer a block upload of few bytes as any other (CiA 301 §7.2.4.3.12), but not a block download.
  const bool fits = is_upload() ? kind == SdoAnswer::upload : !block_ && confirms_write(settings_, answer);
  if (fits) {
    return is_upload() ? on_upload_accepted(answer) : on_download_accepted(answer);
  }
  if (late_possible) {
    return Step::ignored;
  }
  if (!is_upload() && kind == SdoAnswer::upload) {
    return fail(answer_text(answer) +
                " to a write looks like one to a read (sdo quirk accept_upload_style_write_answer is off)");
  }
  return fail(answer_text(answer) + " does not fit the request", kAbortCommandUnknown);
}

SdoTransfer::Step SdoTransfer::on_upload_accepted(std::span<const std::uint8_t> answer) {
  const UploadAnswer accepted = decode_upload_answer(answer);
  if (accepted.expedited) {
    const std::size_t length = expedited_length(accepted, expected_);
    if (!long_enough(settings_, answer, 4 + length)) {
      return fail(too_short(answer, settings_));
    }
    data_.assign(answer.begin() + 4, answer.begin() + 4 + static_cast<std::ptrdiff_t>(length));
    return complete();
  }
  if (!long_enough(settings_, answer, (answer[0] & 0x01U) != 0 ? 8 : 4)) {
    return fail(too_short(answer, settings_), kAbortLengthMismatch);
  }
  if (accepted.size && *accepted.size > kMaxBytes) {
    return fail(std::to_string(*accepted.size) + " bytes are more than are taken", kAbortOutOfMemory);
  }
  phase_ = Phase::segments;
  request_ = upload_segment_request(toggle_);
  return Step::more;
}

SdoTransfer::Step SdoTransfer::on_download_accepted(std::span<const std::uint8_t> answer) {
  const bool upload_style = sdo_answer_of(answer[0]) == SdoAnswer::upload;
  if (upload_style && data_.size() > kMaxExpeditedBytes) {
    return fail(answer_text(answer) + " does not fit a segmented write", kAbortCommandUnknown);
  }
  const std::size_t length = upload_style ? expedited_length(decode_upload_answer(answer), data_.size()) : 0;
  if (!long_enough(settings_, answer, 4 + length)) {
    return fail(too_short(answer, settings_));
  }
  if (data_.size() > kMaxExpeditedBytes) {
    phase_ = Phase::segments;
    return next_download_segment();
  }
  if (upload_style) {
    const std::span<const std::uint8_t> back = answer.subspan(4, length);
    const std::size_t common = std::min(back.size(), data_.size());
    if (!std::equal(data_.begin(), data_.begin() + static_cast<std::ptrdiff_t>(common), back.begin())) {
      remark_ = "the confirmation of the write shows other data than was written";
    }
  }
  return complete();
}

SdoTransfer::Step SdoTransfer::on_segment(std::span<const std::uint8_t> answer) {
  const SdoAnswer kind = sdo_answer_of(answer[0]);
  if (kind == SdoAnswer::upload || kind == SdoAnswer::download) {
    return Step::ignored;  // The late answer to an earlier try of the first request.
  }
  const SdoAnswer wanted = is_upload() ? SdoAnswer::upload_segment : SdoAnswer::download_segment;
  if (kind != wanted) {
    return fail(answer_text(answer) + " does not fit a segment", kAbortCommandUnknown);
  }
  if (toggle_of(answer[0]) != toggle_) {
    if (newest_ == whole_frame(answer)) {
      return Step::ignored;
    }
    return fail("toggle bit not alternated", kAbortToggle);
  }
  newest_ = whole_frame(answer);
  toggle_ = !toggle_;
  if (is_upload()) {
    return on_upload_segment(answer);
  }
  if (!long_enough(settings_, answer, 1)) {
    return fail(too_short(answer, settings_), kAbortLengthMismatch);
  }
  return sent_ == data_.size() ? complete() : next_download_segment();
}

SdoTransfer::Step SdoTransfer::on_upload_segment(std::span<const std::uint8_t> answer) {
  const std::optional<UploadSegment> segment = decode_upload_segment(answer);
  if (!segment || !long_enough(settings_, answer, 1 + segment->data.size())) {
    return fail(too_short(answer, settings_), kAbortLengthMismatch);
  }
  // The announced size is a hint: some devices announce 0, or count a terminator that they do not send. A segment
  // without data would let a device keep us here for ever.
  if (data_.size() + segment->data.size() > kMaxBytes || (segment->data.empty() && !segment->last)) {
    return fail("segments without data, or more than are taken", kAbortLengthMismatch);
  }
  data_.insert(data_.end(), segment->data.begin(), segment->data.end());
  if (segment->last) {
    return complete();
  }
  request_ = upload_segment_request(toggle_);
  return Step::more;
}

SdoTransfer::Step SdoTransfer::next_download_segment() {
  const std::size_t size = std::min(data_.size() - sent_, kSegmentBytes);
  const std::span<const std::uint8_t> data(data_);
  request_ = download_segment_request(toggle_, sent_ + size == data_.size(), data.subspan(sent_, size));
  sent_ += size;
  return Step::more;
}

SdoTransfer::Step SdoTransfer::complete() {
  phase_ = Phase::over;
  return Step::completed;
}

SdoTransfer::Step SdoTransfer::fail(std::string why, std::uint32_t abort_code) {
  phase_ = Phase::over;
  error_.kind = ErrorKind::protocol;
  error_.detail = std::move(why);
  if (abort_code != 0) {
    abort_ = abort_request(object_, abort_code);
  }
  return Step::failed;
}

}  // namespace canopen
