#pragma once

#include <cstdint>
#include <optional>

#include "canopen/object.h"
#include "tests/support/block_codec.h"
#include "tests/support/block_faults.h"

namespace support::block {

/// The server's part of a block download (CiA 301 §7.2.4.3.9 to 11), from the confirmed initiate to its end.
class BlockReceiver {
 public:
  enum class Progress : std::uint8_t { more, gap, sub_block_over, bad_sequence_number };

  /// `size` is what the client indicated; `crc`, whether both sides can do it.
  BlockReceiver(canopen::ObjectAddress object, std::optional<std::uint32_t> size, bool crc, std::uint8_t block_size)
      : object_(object), size_(size), crc_(crc), block_size_(block_size) {}

  [[nodiscard]] canopen::ObjectAddress object() const noexcept { return object_; }
  [[nodiscard]] std::optional<std::uint32_t> size() const noexcept { return size_; }
  [[nodiscard]] bool crc() const noexcept { return crc_; }
  /// Whether the client's next frame is a segment, else the end.
  [[nodiscard]] bool in_sub_block() const noexcept { return !ended_; }
  [[nodiscard]] Place place(const Content& segment) const noexcept { return {sub_block_, field(segment, 0, 7)}; }

  /// A segment that is not the next one is discarded. The sub-block is over with its highest sequence number and with
  /// the segment that is marked as the last, whatever was lost before.
  Progress take(const Content& segment);
  /// The number of the last segment that came in order: 0 where the first one did not.
  [[nodiscard]] std::uint8_t ackseq() const noexcept { return received_; }
  /// Forgets what came after the segment `seqno` of this sub-block.
  void discard_after(std::uint8_t seqno);
  /// Discards every segment until the first one of the next sub-block: those the client sends before it hears of an
  /// early acknowledgement.
  void skip_to_first() noexcept { skipping_ = true; }
  /// After the acknowledgement: the next sub-block, or the end where the last segment is there.
  void next(std::uint8_t block_size);
  [[nodiscard]] unsigned sub_block() const noexcept { return sub_block_; }

  /// All data, without the `unused` last bytes (0..7) of the last segment.
  [[nodiscard]] Bytes data(std::uint8_t unused) const;

 private:
  canopen::ObjectAddress object_;
  std::optional<std::uint32_t> size_;
  bool crc_;
  std::uint8_t block_size_;
  unsigned sub_block_ = 1;
  std::uint8_t received_ = 0;
  bool last_there_ = false;
  bool skipping_ = false;
  bool ended_ = false;
  Bytes data_;
};

}  // namespace support::block
