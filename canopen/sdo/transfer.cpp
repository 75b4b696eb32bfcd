#include "canopen/sdo/transfer.h"

#include <algorithm>
#include <utility>

#include "canopen/hex.h"

namespace canopen {
namespace {

// CiA 301 table 22.
constexpr std::uint32_t kToggleNotAlternated = 0x05030000;
constexpr std::uint32_t kCommandUnknown = 0x05040001;
constexpr std::uint32_t kOutOfMemory = 0x05040005;
constexpr std::uint32_t kLengthMismatch = 0x06070010;

std::string answer_text(std::span<const std::uint8_t> answer) {
  return "answer 0x" + hex(answer[0], 2) + " of " + std::to_string(answer.size()) + " bytes";
}

std::string too_short(std::span<const std::uint8_t> answer, const SdoSettings& settings) {
  const std::string text = answer_text(answer) + " is too short";
  return settings.accept_short_answers ? text : text + " (sdo quirk accept_short_answers is off)";
}

}  // namespace

SdoTransfer SdoTransfer::upload(const SdoSettings& settings, ObjectAddress object, std::size_t expected) {
  SdoTransfer transfer(settings, object, Direction::upload, upload_request(object));
  transfer.expected_ = expected;
  return transfer;
}

SdoTransfer SdoTransfer::download(const SdoSettings& settings, ObjectAddress object,
                                  std::span<const std::uint8_t> data) {
  SdoTransfer transfer(settings, object, Direction::download, download_request(object, data));
  transfer.data_.assign(data.begin(), data.end());
  return transfer;
}

SdoTransfer::Step SdoTransfer::on_answer(std::span<const std::uint8_t> answer, bool late_possible) {
  if (answer.empty() || phase_ == Phase::over) {
    return Step::ignored;
  }
  if (sdo_answer_of(answer[0]) == SdoAnswer::abort) {
    return on_abort(answer, late_possible);
  }
  return phase_ == Phase::initiate ? on_initiate(answer, late_possible) : on_segment(answer);
}

SdoTransfer::Step SdoTransfer::on_abort(std::span<const std::uint8_t> answer, bool late_possible) {
  const std::optional<ObjectAddress> address = address_of(answer);
  if (address ? *address != object_ : late_possible) {
    return Step::ignored;
  }
  phase_ = Phase::over;
  error_.kind = ErrorKind::refused;
  if (answer.size() >= 8) {
    error_.abort = decode_u32(answer.subspan(4));
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
  const bool fits = is_upload() ? kind == SdoAnswer::upload : confirms_write(settings_, answer);
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
  return fail(answer_text(answer) + " does not fit the request", kCommandUnknown);
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
    return fail(too_short(answer, settings_), kLengthMismatch);
  }
  if (accepted.size && *accepted.size > kMaxBytes) {
    return fail(std::to_string(*accepted.size) + " bytes are more than are taken", kOutOfMemory);
  }
  phase_ = Phase::segments;
  request_ = upload_segment_request(toggle_);
  return Step::more;
}

SdoTransfer::Step SdoTransfer::on_download_accepted(std::span<const std::uint8_t> answer) {
  const bool upload_style = sdo_answer_of(answer[0]) == SdoAnswer::upload;
  if (upload_style && data_.size() > kMaxExpeditedBytes) {
    return fail(answer_text(answer) + " does not fit a segmented write", kCommandUnknown);
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
    return fail(answer_text(answer) + " does not fit a segment", kCommandUnknown);
  }
  if (toggle_of(answer[0]) != toggle_) {
    return fail("toggle bit not alternated", kToggleNotAlternated);
  }
  toggle_ = !toggle_;
  if (is_upload()) {
    return on_upload_segment(answer);
  }
  if (!long_enough(settings_, answer, 1)) {
    return fail(too_short(answer, settings_), kLengthMismatch);
  }
  return sent_ == data_.size() ? complete() : next_download_segment();
}

SdoTransfer::Step SdoTransfer::on_upload_segment(std::span<const std::uint8_t> answer) {
  const std::optional<UploadSegment> segment = decode_upload_segment(answer);
  if (!segment || !long_enough(settings_, answer, 1 + segment->data.size())) {
    return fail(too_short(answer, settings_), kLengthMismatch);
  }
  // The announced size is a hint: some devices announce 0, or count a terminator that they do not send. A segment
  // without data would let a device keep us here for ever.
  if (data_.size() + segment->data.size() > kMaxBytes || (segment->data.empty() && !segment->last)) {
    return fail("segments without data, or more than are taken", kLengthMismatch);
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
