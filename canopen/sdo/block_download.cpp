#include "canopen/sdo/block_download.h"

#include <algorithm>
#include <utility>

#include "canopen/sdo/abort_codes.h"
#include "canopen/sdo/block_frames.h"
#include "canopen/sdo/crc16.h"

namespace canopen {
namespace {

std::size_t segments_of(std::size_t bytes) noexcept {
  return (bytes + kSegmentBytes - 1) / kSegmentBytes;
}

}  // namespace

SdoBlockDownload::SdoBlockDownload(std::vector<std::uint8_t> data, std::span<const std::uint8_t> accepted)
    : data_(std::move(data)), crc_(supports_crc(accepted[0])), first_size_(accepted[4]) {}

SdoReaction SdoBlockDownload::on_answer(std::span<const std::uint8_t> answer) {
  if (sdo_answer_of(answer[0]) != SdoAnswer::block_download) {
    return failed("the answer does not fit a block download", kAbortCommandUnknown);
  }
  switch (block_download_answer_of(answer[0])) {
    case BlockAnswer::initiate:
      return {};  // Doubled.
    case BlockAnswer::acknowledge:
      return ending_ ? SdoReaction{} : on_acknowledge(answer[1], answer[2]);
    case BlockAnswer::end:
      if (ending_) {
        return {.step = SdoStep::completed};
      }
      break;
    case BlockAnswer::reserved:
      break;
  }
  return failed("the answer does not fit a block download", kAbortCommandUnknown);
}

// A server that misses a segment may say so at once, or at the end of the sub-block. What it got is never taken back. A
// frame that comes twice, as CAN may do it, comes before another of ours leaves. It would be told from an
// acknowledgement of the next sub-block by nothing else where that has one segment.
SdoReaction SdoBlockDownload::on_acknowledge(std::uint8_t number, std::uint8_t segments) {
  const Acknowledge acknowledge{number, segments};
  if (newest_ == acknowledge) {
    return {};
  }
  newest_ = acknowledge;
  const bool all_sent = given_ == segments_;
  if (number > given_ || (number == given_ && !all_sent)) {
    return all_sent ? failed("segments were acknowledged that were not sent", kAbortSequenceNumber) : SdoReaction{};
  }
  without_any_ = number == 0 ? without_any_ + 1 : 0;
  if (without_any_ >= kMostWithoutAny) {
    return failed("no segment is taken", kAbortSequenceNumber);
  }
  acknowledged_ = std::min(acknowledged_ + number * kSegmentBytes, data_.size());
  if (acknowledged_ < data_.size()) {
    return begin_sub_block(segments);
  }
  ending_ = true;
  const std::size_t unused = segments_of(data_.size()) * kSegmentBytes - data_.size();
  return {.step = SdoStep::more, .request = block_download_end(unused, crc_ ? crc16(data_) : std::uint16_t{0})};
}

SdoReaction SdoBlockDownload::on_departure() {
  newest_.reset();
  return ending_ || given_ == segments_ ? SdoReaction{} : next_segment();
}

SdoReaction SdoBlockDownload::begin_sub_block(std::uint8_t segments) {
  if (segments == 0 || segments > kMostBlockSegments) {
    return failed("sub-blocks of " + std::to_string(segments) + " segments", kAbortBlockSize);
  }
  given_ = 0;
  segments_ = static_cast<std::uint8_t>(std::min<std::size_t>(segments, segments_of(data_.size() - acknowledged_)));
  return next_segment();
}

SdoReaction SdoBlockDownload::next_segment() {
  const std::size_t begin = acknowledged_ + given_ * kSegmentBytes;
  const std::size_t size = std::min(data_.size() - begin, kSegmentBytes);
  ++given_;
  const std::span<const std::uint8_t> data = std::span<const std::uint8_t>(data_).subspan(begin, size);
  return {.step = SdoStep::more, .request = block_segment(given_, begin + size == data_.size(), data)};
}

}  // namespace canopen
