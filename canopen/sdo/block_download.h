#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "canopen/sdo/step.h"

namespace canopen {

/// A block download that the server has accepted, without time or bus (CiA 301 §7.2.4.3.9 to §7.2.4.3.11): frames of
/// the server and departures of ours in, requests out. Of a sub-block one segment follows the departure of the other;
/// from what the server did not get in order on, it is sent again.
class SdoBlockDownload {
 public:
  /// `data`: at least one byte. `accepted`: the server's answer, 8 bytes.
  SdoBlockDownload(std::vector<std::uint8_t> data, std::span<const std::uint8_t> accepted);

  /// The first segment; or `failed`, where the server's sub-blocks have no allowed size.
  [[nodiscard]] SdoReaction begin() { return begin_sub_block(first_size_); }
  /// 8 bytes that are no abort.
  [[nodiscard]] SdoReaction on_answer(std::span<const std::uint8_t> answer);
  /// Our newest request has left.
  [[nodiscard]] SdoReaction on_departure();

 private:
  /// Number of the last segment that was taken, and how many the next sub-block may have.
  using Acknowledge = std::pair<std::uint8_t, std::uint8_t>;

  [[nodiscard]] SdoReaction begin_sub_block(std::uint8_t segments);
  [[nodiscard]] SdoReaction next_segment();
  [[nodiscard]] SdoReaction on_acknowledge(std::uint8_t number, std::uint8_t segments);

  std::vector<std::uint8_t> data_;
  bool crc_;
  std::uint8_t first_size_;
  std::size_t acknowledged_ = 0;       ///< Bytes.
  std::uint8_t given_ = 0;             ///< Segments of this sub-block that were sent,
  std::uint8_t segments_ = 0;          ///< of so many.
  unsigned without_any_ = 0;           ///< Sub-blocks in a row of which the server took nothing.
  std::optional<Acknowledge> newest_;  ///< Since it came no segment of ours has left.
  bool ending_ = false;                ///< All is there, and the end was sent.
};

}  // namespace canopen
