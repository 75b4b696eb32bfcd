#include "canopen/sdo/block_upload.h"

#include <algorithm>
#include <string>
#include <utility>

#include "canopen/sdo/abort_codes.h"
#include "canopen/sdo/block_frames.h"
#include "canopen/sdo/crc16.h"

namespace canopen {
SdoBlockUpload::SdoBlockUpload(std::span<const std::uint8_t> accepted, std::size_t most) noexcept
    : crc_(supports_crc(accepted[0])), most_(most), newest_(whole_frame(accepted)) {}

SdoReaction SdoBlockUpload::on_answer(std::span<const std::uint8_t> frame) {
  const SdoFrame copy = whole_frame(frame);
  if (newest_ == copy || state_ == State::confirmed) {
    return {};
  }
  newest_ = copy;
  return state_ == State::segments ? on_segment(frame) : on_end(frame);
}

SdoReaction SdoBlockUpload::on_segment(std::span<const std::uint8_t> frame) {
  const BlockSegment segment = decode_block_segment(frame);
  if (segment.number == 0 || segment.number > kSegments) {
    return failed("segment " + std::to_string(segment.number) + " of a sub-block of " + std::to_string(kSegments),
                  kAbortSequenceNumber);
  }
  const bool ends_sub_block = segment.last || segment.number == kSegments;
  if (segment.number == in_order_ + 1) {
    ++in_order_;
    has_last_ = segment.last;
    // Of the last segment the end tells how many bytes count.
    if (data_.size() > most_) {
      return failed("more than the " + std::to_string(most_) + " bytes that are taken", kAbortOutOfMemory);
    }
    data_.insert(data_.end(), segment.data.begin(), segment.data.end());
  } else if (++out_of_order_ > kSegments) {
    return failed("segments of a sub-block come again and again", kAbortSequenceNumber);
  }
  return ends_sub_block ? acknowledge() : SdoReaction{.step = SdoStep::taken};
}

SdoReaction SdoBlockUpload::on_end(std::span<const std::uint8_t> frame) {
  if (sdo_answer_of(frame[0]) != SdoAnswer::block_upload || block_upload_answer_of(frame[0]) != BlockAnswer::end) {
    return failed("the answer does not end a block upload", kAbortCommandUnknown);
  }
  const BlockUploadEnd end = decode_block_upload_end(frame);
  data_.resize(data_.size() - std::min(end.unused, data_.size()));
  if (data_.size() > most_) {
    return failed("more than the " + std::to_string(most_) + " bytes that are taken", kAbortOutOfMemory);
  }
  if (crc_ && crc16(data_) != end.crc) {
    return failed("the check sum of the block upload is wrong", kAbortCrc);
  }
  state_ = State::confirmed;
  return {.step = SdoStep::more, .request = block_upload_end()};
}

SdoReaction SdoBlockUpload::on_departure() const {
  return complete() ? SdoReaction{.step = SdoStep::completed} : SdoReaction{};
}

SdoReaction SdoBlockUpload::acknowledge() {
  without_any_ = in_order_ == 0 ? without_any_ + 1 : 0;
  if (without_any_ >= kMostWithoutAny) {
    return failed("no segment comes in order", kAbortSequenceNumber);
  }
  out_of_order_ = 0;
  state_ = has_last_ ? State::end : State::segments;
  return {.step = SdoStep::more, .request = block_upload_acknowledge(std::exchange(in_order_, 0), kSegments)};
}

}  // namespace canopen
