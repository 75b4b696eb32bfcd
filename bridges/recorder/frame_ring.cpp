#include "bridges/recorder/frame_ring.h"

#include <algorithm>
#include <atomic>
#include <utility>

namespace recorder {
namespace {

// Short frames come twice as often as long ones: 47 bits without data, 111 with eight bytes.
constexpr std::uint64_t kBitsOfAFrame = 111;
constexpr std::uint32_t kFastest = 1'000'000;

KeptFrame::Kind kind_of(const canopen::Frame& frame) noexcept {
  if (frame.error) {
    return KeptFrame::Kind::error;
  }
  return frame.remote ? KeptFrame::Kind::remote : KeptFrame::Kind::data;
}

}  // namespace

FrameRing::FrameRing(canopen::Duration kept, std::size_t most)
    : kept_(kept), most_chunks_(std::max<std::size_t>(2, (most + kFramesAChunk - 1) / kFramesAChunk + 1)) {}

void FrameRing::on_frame(const canopen::Received& received, canopen::FrameOrigin /*origin*/) {
  const canopen::Frame& frame = received.frame;
  push({received.at, received.wall, frame.id, frame.size, kind_of(frame), frame.extended, frame.data});
}

void FrameRing::on_frames_lost(std::uint32_t count) {
  push({canopen::Clock::now(), canopen::wall_now(), count, 0, KeptFrame::Kind::gap, false, {}});
}

void FrameRing::begin_chunk(canopen::TimePoint now) {
  canopen::TimePoint wanted = now - kept_;
  if (held_from_) {
    wanted = std::min(wanted, *held_from_);
  }
  std::shared_ptr<FrameChunk> dropped;
  const auto drop_front = [&] {
    dropped = std::move(chunks_.front());
    chunks_.pop_front();
  };
  while (!chunks_.empty() && chunks_.front()->back().at < wanted) {
    drop_front();
  }
  while (chunks_.size() >= most_chunks_) {
    dropped_ = chunks_.front()->back().at;
    drop_front();
  }
  // New memory is cleared by the system and by us, which costs more than to write it.
  const bool is_ours = dropped && dropped.use_count() == 1;
  std::atomic_thread_fence(std::memory_order_acquire);  // Behind the last look of a thread that had a slice of it.
  chunks_.push_back(is_ours ? std::move(dropped) : std::make_shared<FrameChunk>());
  newest_ = chunks_.back()->data();
  used_ = 0;
}

FrameSlice FrameRing::slice(canopen::TimePoint from, canopen::TimePoint until) const {
  FrameSlice slice{.from = from, .until = until, .cut = dropped_ && *dropped_ >= from};
  for (const auto& chunk : chunks_) {
    const std::size_t count = chunk == chunks_.back() ? used_ : kFramesAChunk;
    if (count > 0 && (*chunk)[count - 1].at >= from) {
      slice.pieces.push_back({chunk, count});
    }
  }
  return slice;
}

std::size_t most_frames(std::optional<std::uint32_t> bitrate, canopen::Duration time) {
  const auto ms = static_cast<std::uint64_t>(std::chrono::ceil<std::chrono::milliseconds>(time).count());
  return bitrate.value_or(kFastest) * ms / (kBitsOfAFrame * 1000) + 1;
}

}  // namespace recorder
