#include "tests/support/block_sender.h"

#include <algorithm>

namespace support::block {

std::vector<Content> BlockSender::next_sub_block() {
  std::vector<Content> sub_block;
  sent_ = std::min<std::size_t>(block_size_, segments() - first_);
  for (std::size_t i = 0; i < sent_; ++i) {
    const std::size_t number = first_ + i;
    const unsigned last = number + 1 == segments() ? 0x80U : 0U;
    Content segment = command(last | static_cast<unsigned>(i + 1));
    put_segment(segment, data_, number * kSegmentBytes);
    sub_block.push_back(segment);
  }
  ++sub_block_;
  phase_ = Phase::acknowledge;
  return sub_block;
}

bool BlockSender::acknowledge(std::uint8_t ackseq, std::uint8_t block_size) {
  if (ackseq > sent_) {
    return false;
  }
  first_ += ackseq;
  block_size_ = block_size;
  return true;
}

Content BlockSender::end() {
  phase_ = Phase::end;
  Content content = command(0xC1U | static_cast<unsigned>(segments() * kSegmentBytes - data_.size()) << 2U);
  put_u16(content, 1, crc_ ? crc16(data_) : std::uint16_t{0});
  return content;
}

}  // namespace support::block
