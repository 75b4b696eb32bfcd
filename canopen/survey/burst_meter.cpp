#include "canopen/survey/burst_meter.h"

#include <algorithm>

#include "canopen/bus/wire_bits.h"

namespace canopen {

void BurstMeter::set_bitrate(std::uint32_t bitrate) noexcept {
  // Of one end of a frame to the next: eight bytes with every stuff bit, and a quarter for what a time stamp is late.
  constexpr std::int64_t kBitsBetween = std::int64_t{wire_bits(8, Stuffing::worst)} * 5 / 4;
  longest_gap_ = bitrate == 0 ? Duration::zero() : Duration(kBitsBetween * 1'000'000'000 / bitrate);
  count_ = 0;
  first_ = last_ = {};
}

void BurstMeter::settle(TimePoint now, std::uint32_t hour) noexcept {
  // Frames that were not read yet may go on with it.
  constexpr Duration kLongOver = std::chrono::seconds(1);
  if (now - last_ > longest_gap_ + kLongOver) {
    end(hour);
  }
}

void BurstMeter::end(std::uint32_t hour) noexcept {
  if (count_ > 0) {
    frames_.add(count_, hour);
    times_.add(to_units(last_ - first_), hour);
  }
  count_ = 0;
  first_ = last_ = {};
}

void BurstMeter::hear(const Moment& moment) noexcept {
  if (longest_gap_ == Duration::zero()) {
    return;
  }
  if (count_ > 0 && moment.at - last_ <= longest_gap_ && unbroken_ == moment.unbroken) {
    ++count_;
  } else {
    end(moment.hour);
    count_ = 1;
    first_ = moment.at;
    unbroken_ = moment.unbroken;
  }
  last_ = moment.at;
}

std::optional<Burst> BurstMeter::of_day(std::uint32_t hour) const noexcept {
  const std::optional<Extremes> frames = frames_.of_day(hour);
  const std::optional<Extremes> times = times_.of_day(hour);
  if (count_ == 0 && !frames) {
    return std::nullopt;
  }
  return Burst{.frames = std::max(count_, frames ? frames->most : 0),
               .time = std::max(last_ - first_, times ? from_units(times->most) : Duration::zero())};
}

}  // namespace canopen
