#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <vector>

#include "canopen/bus/frame_tap.h"
#include "canopen/bus/link.h"
#include "canopen/clock.h"

namespace recorder {

/// A frame as it is kept, or so many that were lost.
struct KeptFrame {
  enum class Kind : std::uint8_t { data, remote, error, gap };

  canopen::TimePoint at;   ///< Of reception; of a gap when it was told.
  canopen::WallTime wall;  ///< Likewise.
  std::uint32_t id = 0;    ///< Of an error frame its class bits; of a gap how many frames were lost.
  std::uint8_t size = 0;   ///< Bytes of `data`.
  Kind kind = Kind::data;
  bool extended = false;
  std::array<std::uint8_t, 8> data{};
};
// What a bus costs in memory is documented by this figure.
static_assert(sizeof(KeptFrame) == 32);

/// Frames are kept by so many at a time.
inline constexpr std::size_t kFramesAChunk = 2048;
using FrameChunk = std::array<KeptFrame, kFramesAChunk>;

/// Frames between two moments, in order of reception. The ring they are of goes on behind them: what is listed here is
/// never written again, so another thread may read it.
struct FrameSlice {
  struct Piece {
    std::shared_ptr<const FrameChunk> chunk;  ///< The ring's, too, until it drops it.
    std::size_t count = 0;                    ///< Of the first ones.
  };
  std::vector<Piece> pieces{};
  canopen::TimePoint from{};
  canopen::TimePoint until{};
  bool cut = false;  ///< There were more than the ring holds: its oldest are missing.

  template <class See>
  void each(See see) const {
    for (const Piece& piece : pieces) {
      for (std::size_t i = 0; i < piece.count; ++i) {
        const KeptFrame& frame = (*piece.chunk)[i];
        if (frame.at >= from && frame.at <= until) {
          see(frame);
        }
      }
    }
  }
};

/// The frames of one bus of the last while, in memory. Keeping one is a copy of 32 bytes; each kFramesAChunk of them
/// take memory once.
class FrameRing final : public canopen::FrameTap {
 public:
  /// Of `kept` at least; `most` frames at most, rounded up to whole chunks: then the oldest are dropped.
  FrameRing(canopen::Duration kept, std::size_t most);

  void on_frame(const canopen::Received& frame, canopen::FrameOrigin origin) override;
  void on_frames_lost(std::uint32_t count) override;

  /// Nothing that came since then is dropped for its age, until release().
  void hold(canopen::TimePoint from) noexcept { held_from_ = from; }
  void release() noexcept { held_from_.reset(); }
  [[nodiscard]] FrameSlice slice(canopen::TimePoint from, canopen::TimePoint until) const;
  /// Bytes of all frames.
  [[nodiscard]] std::size_t memory() const noexcept { return chunks_.size() * sizeof(FrameChunk); }

 private:
  void push(const KeptFrame& frame) {
    if (used_ == kFramesAChunk) {
      begin_chunk(frame.at);
    }
    // The place of one that comes soon: waiting for its memory cost more than all the rest (12 % of a frame's way into
    // the process image, not 2 %).
    constexpr std::size_t kAhead = 4;
    __builtin_prefetch(newest_ + std::min(used_ + kAhead, kFramesAChunk - 1), 1);
    newest_[used_++] = frame;
  }
  void begin_chunk(canopen::TimePoint now);

  canopen::Duration kept_;
  std::size_t most_chunks_;
  std::deque<std::shared_ptr<FrameChunk>> chunks_;  ///< All but the last are full.
  std::size_t used_ = kFramesAChunk;                ///< Of the last.
  KeptFrame* newest_ = nullptr;                     ///< The first of the last chunk.
  std::optional<canopen::TimePoint> held_from_;
  std::optional<canopen::TimePoint> dropped_;  ///< The newest one that was dropped for want of room.
};

/// What a bus of this bit rate can carry in that time, of frames of eight bytes (111 bits); without a bit rate as one
/// of 1 Mbit/s, the fastest there is.
[[nodiscard]] std::size_t most_frames(std::optional<std::uint32_t> bitrate, canopen::Duration time);

}  // namespace recorder
