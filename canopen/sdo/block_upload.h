#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "canopen/sdo/step.h"

namespace canopen {

/// A block upload that the server has accepted, without time or bus (CiA 301 §7.2.4.3.12 to §7.2.4.3.15): frames of the
/// server in, requests out. What does not come in order is asked for again at the end of the sub-block. Where that end
/// does not come nothing is asked for: frames that are only late would pass for those of the repetition.
class SdoBlockUpload {
 public:
  /// Segments of a sub-block. So few that the first byte of a segment is none of an answer that confirms a write, nor
  /// begins an upload: those that come after an abort of ours can pass for nothing but a segment.
  static constexpr std::uint8_t kSegments = 31;

  /// `accepted`: the server's answer, 8 bytes. `most`: bytes that are taken.
  SdoBlockUpload(std::span<const std::uint8_t> accepted, std::size_t most) noexcept;

  /// 8 bytes that are no abort.
  [[nodiscard]] SdoReaction on_answer(std::span<const std::uint8_t> frame);
  /// Our newest request has left.
  [[nodiscard]] SdoReaction on_departure() const;
  /// In the middle of a sub-block: any first byte from 1 on is that of a segment.
  [[nodiscard]] bool wants_segments() const noexcept { return state_ == State::segments; }
  /// Nothing but the last confirmation is to be sent.
  [[nodiscard]] bool complete() const noexcept { return state_ == State::confirmed; }
  [[nodiscard]] const std::vector<std::uint8_t>& data() const noexcept { return data_; }

 private:
  enum class State : std::uint8_t { segments, end, confirmed };

  [[nodiscard]] SdoReaction on_segment(std::span<const std::uint8_t> frame);
  [[nodiscard]] SdoReaction on_end(std::span<const std::uint8_t> frame);
  [[nodiscard]] SdoReaction acknowledge();

  bool crc_;
  std::size_t most_;
  State state_ = State::segments;
  std::vector<std::uint8_t> data_;
  std::uint8_t in_order_ = 0;       ///< Segments of this sub-block, from the first on.
  unsigned out_of_order_ = 0;       ///< Others of it: behind a gap fewer than a sub-block has.
  bool has_last_ = false;           ///< The last one of all is among them.
  unsigned without_any_ = 0;        ///< Sub-blocks in a row without one in order.
  std::optional<SdoFrame> newest_;  ///< See SdoTransfer::newest_.
};

}  // namespace canopen
