#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "canopen/object.h"
#include "tests/support/block_codec.h"
#include "tests/support/block_faults.h"

namespace support::block {

/// The server's part of a block upload (CiA 301 §7.2.4.3.13 to 15), from the answered initiate to the client's last
/// word.
class BlockSender {
 public:
  /// What the client has to say next.
  enum class Phase : std::uint8_t { start, acknowledge, end };

  BlockSender(canopen::ObjectAddress object, Bytes data, bool crc, std::uint8_t block_size)
      : object_(object), data_(std::move(data)), crc_(crc), block_size_(block_size) {}

  [[nodiscard]] canopen::ObjectAddress object() const noexcept { return object_; }
  [[nodiscard]] Phase phase() const noexcept { return phase_; }
  [[nodiscard]] Place place(const Content& segment) const noexcept { return {sub_block_, field(segment, 0, 7)}; }

  /// The segments of the next sub-block: those after the last acknowledged one, numbered from 1 again.
  [[nodiscard]] std::vector<Content> next_sub_block();
  /// Whether the number is one of the sub-block just sent, or 0.
  [[nodiscard]] bool acknowledge(std::uint8_t ackseq, std::uint8_t block_size);
  /// Whether the last segment has been acknowledged.
  [[nodiscard]] bool all_acknowledged() const noexcept { return first_ == segments(); }
  /// The end of the transfer: how many bytes of the last segment are none of the data, and the CRC where both can do
  /// it.
  [[nodiscard]] Content end();

 private:
  /// Data without a byte are one segment without a byte.
  [[nodiscard]] std::size_t segments() const noexcept {
    return data_.empty() ? 1 : (data_.size() + kSegmentBytes - 1) / kSegmentBytes;
  }

  canopen::ObjectAddress object_;
  Bytes data_;
  bool crc_;
  std::uint8_t block_size_;
  Phase phase_ = Phase::start;
  unsigned sub_block_ = 0;
  std::size_t first_ = 0;  ///< Segments acknowledged, which is the number of the next sub-block's first, from 0.
  std::size_t sent_ = 0;   ///< Segments of the sub-block just sent.
};

}  // namespace support::block
