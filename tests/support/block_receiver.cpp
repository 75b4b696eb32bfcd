#include "tests/support/block_receiver.h"

namespace support::block {

BlockReceiver::Progress BlockReceiver::take(const Content& segment) {
  const std::uint8_t seqno = field(segment, 0, 7);
  const bool last = field(segment, 7, 1) != 0;
  if (skipping_ && seqno != 1) {
    return Progress::more;
  }
  skipping_ = false;
  if (seqno == 0 || seqno > block_size_) {
    return Progress::bad_sequence_number;
  }
  if (seqno == received_ + 1) {
    data_.insert(data_.end(), segment.begin() + 1, segment.end());
    received_ = seqno;
    last_there_ = last;
  }
  if (last || seqno == block_size_) {
    return Progress::sub_block_over;
  }
  return seqno > received_ ? Progress::gap : Progress::more;
}

void BlockReceiver::discard_after(std::uint8_t seqno) {
  if (seqno < received_) {
    data_.resize(data_.size() - kSegmentBytes * static_cast<std::size_t>(received_ - seqno));
    received_ = seqno;
    last_there_ = false;
  }
}

void BlockReceiver::next(std::uint8_t block_size) {
  ended_ = last_there_;
  block_size_ = block_size;
  received_ = 0;
  ++sub_block_;
}

Bytes BlockReceiver::data(std::uint8_t unused) const {
  return {data_.begin(), data_.end() - static_cast<std::ptrdiff_t>(unused)};
}

}  // namespace support::block
