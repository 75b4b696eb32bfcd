#include "canopen/bus/bus_load.h"

#include <algorithm>

#include "canopen/bus/wire_bits.h"

namespace canopen {
namespace {

constexpr Duration kSlice = std::chrono::milliseconds(100);

std::uint16_t share(std::uint64_t bits, std::uint32_t bitrate) noexcept {
  return bitrate == 0 ? std::uint16_t{0}
                      : static_cast<std::uint16_t>(std::min<std::uint64_t>(bits * 1000 / bitrate, 1000));
}

}  // namespace

std::uint32_t bits_on_wire(const Frame& frame) noexcept {
  return wire_bits(frame.remote ? 0U : frame.size, Stuffing::usual, frame.extended);
}

void BusLoad::add(const Frame& frame, TimePoint at) noexcept {
  move_to(at);
  Bits& slice = slices_[static_cast<std::size_t>(current_ % (kSlices + 1))];
  (is_sdo(frame) ? slice.sdo : slice.others) += bits_on_wire(frame);
}

std::uint16_t BusLoad::per_mille(std::uint32_t bitrate, TimePoint now) noexcept {
  move_to(now);
  const Bits bits = of_whole_slices();
  return share(std::uint64_t{bits.sdo} + bits.others, bitrate);
}

std::uint16_t BusLoad::highest_per_mille(std::uint32_t bitrate, TimePoint now) noexcept {
  move_to(now);
  return share(highest_, bitrate);
}

std::uint16_t BusLoad::others_per_mille(std::uint32_t bitrate, TimePoint now) noexcept {
  move_to(now);
  return share(of_whole_slices().others, bitrate);
}

BusLoad::Bits BusLoad::of_whole_slices() const noexcept {
  Bits sum;
  for (std::size_t i = 0; i < slices_.size(); ++i) {
    if (i != static_cast<std::size_t>(current_ % (kSlices + 1))) {  // That one is not over.
      sum.sdo += slices_[i].sdo;
      sum.others += slices_[i].others;
    }
  }
  return sum;
}

void BusLoad::move_to(TimePoint now) noexcept {
  const std::int64_t slice = now.time_since_epoch() / kSlice;
  while (current_ < slice) {
    ++current_;
    slices_[static_cast<std::size_t>(current_ % (kSlices + 1))] = {};
    const Bits second = of_whole_slices();
    highest_ = std::max(highest_, std::uint64_t{second.sdo} + second.others);
    if (slice - current_ > kSlices) {
      slices_.fill({});  // In a pause it only falls.
      current_ = slice - 1;
    }
  }
}

}  // namespace canopen
