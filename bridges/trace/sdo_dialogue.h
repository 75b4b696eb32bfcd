#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "bridges/trace/entry.h"
#include "canopen/object.h"

namespace trace {

/// What passes between an SDO client and one server, as somebody sees it who only listens. Frames in any order and of
/// any content: what does not fit is unclear, and nothing more. A plain value.
class SdoDialogue {
 public:
  [[nodiscard]] SdoPart on_request(std::span<const std::uint8_t> frame) noexcept;
  [[nodiscard]] SdoPart on_answer(std::span<const std::uint8_t> frame) noexcept;

 private:
  /// What is under way.
  enum class Mode : std::uint8_t { none, upload, download, block_upload, block_download };

  [[nodiscard]] SdoPart begin(Mode mode, SdoStep step, std::span<const std::uint8_t> frame) noexcept;
  [[nodiscard]] SdoPart part(SdoStep step) const noexcept;
  [[nodiscard]] SdoPart aborted(std::span<const std::uint8_t> frame) noexcept;
  [[nodiscard]] SdoPart whole(SdoPart part, std::span<const std::uint8_t> data) noexcept;
  [[nodiscard]] SdoPart segment(SdoStep step, std::span<const std::uint8_t> frame) noexcept;
  [[nodiscard]] SdoPart block_segment(std::span<const std::uint8_t> frame) noexcept;
  [[nodiscard]] SdoPart block_taken(std::span<const std::uint8_t> frame) noexcept;
  [[nodiscard]] SdoPart block_end(std::span<const std::uint8_t> frame) noexcept;
  [[nodiscard]] SdoPart download_request(std::span<const std::uint8_t> frame) noexcept;
  [[nodiscard]] SdoPart upload_answer(std::span<const std::uint8_t> frame) noexcept;
  [[nodiscard]] SdoPart block_upload_request(std::span<const std::uint8_t> frame) noexcept;
  [[nodiscard]] SdoPart block_download_answer(std::span<const std::uint8_t> frame) noexcept;
  /// False: it comes again, or one before it is missing, which ends what is under way.
  [[nodiscard]] bool comes_next(std::span<const std::uint8_t> frame) noexcept;
  void keep(std::uint32_t position, std::span<const std::uint8_t> data) noexcept;

  Mode mode_ = Mode::none;
  bool segments_ = false;       ///< Of a block: they are on their way.
  bool last_ = false;           ///< The last segment of the value was seen.
  bool toggle_ = false;         ///< Of the next segment.
  std::uint8_t newest_ = 0;     ///< Segment of the block.
  std::uint32_t moved_ = 0;     ///< Bytes.
  std::uint32_t block_at_ = 0;  ///< Bytes before this block.
  canopen::ObjectAddress object_{};
  std::array<std::uint8_t, SdoPart::kKept> data_{};
  std::array<std::uint8_t, 8> segment_{};  ///< The newest one.
};

}  // namespace trace
