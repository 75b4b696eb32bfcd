#include "canopen/bus_load.h"

#include <algorithm>
#include <numeric>

#include "canopen/wire_bits.h"

namespace canopen {
namespace {

constexpr Duration kSlice = std::chrono::milliseconds(100);

}  // namespace

std::uint32_t bits_on_wire(const Frame& frame) noexcept {
  return wire_bits(frame.remote ? 0U : frame.size, Stuffing::usual, frame.extended);
}

void BusLoad::add(const Frame& frame, TimePoint at) noexcept {
  move_to(at);
  slices_[static_cast<std::size_t>(current_ % (kSlices + 1))] += bits_on_wire(frame);
}

std::uint16_t BusLoad::per_mille(std::uint32_t bitrate, TimePoint now) noexcept {
  if (bitrate == 0) {
    return 0;
  }
  move_to(now);
  const std::uint32_t unfinished = slices_[static_cast<std::size_t>(current_ % (kSlices + 1))];
  const std::uint64_t bits = std::accumulate(slices_.begin(), slices_.end(), std::uint64_t{0}) - unfinished;
  return static_cast<std::uint16_t>(std::min<std::uint64_t>(bits * 1000 / bitrate, 1000));
}

void BusLoad::move_to(TimePoint now) noexcept {
  const std::int64_t slice = now.time_since_epoch() / kSlice;
  if (slice - current_ > kSlices) {
    slices_.fill(0);
    current_ = slice;
  }
  while (current_ < slice) {
    ++current_;
    slices_[static_cast<std::size_t>(current_ % (kSlices + 1))] = 0;
  }
}

}  // namespace canopen
