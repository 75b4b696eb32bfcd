#include "canopen/survey/log_histogram.h"

#include <algorithm>
#include <bit>

namespace canopen {
namespace {

// A unit is 1024 ns, so that no frame costs a division.
constexpr unsigned kUnitBits = 10;

}  // namespace

std::size_t LogHistogram::step_of(std::uint32_t units) noexcept {
  if (units < (1U << kStepBits)) {
    return units;
  }
  const unsigned above = static_cast<unsigned>(std::bit_width(units)) - 1 - kStepBits;
  return (std::size_t{above} << kStepBits) + (units >> above);
}

Duration LogHistogram::middle_of(std::size_t step) noexcept {
  constexpr std::size_t kPerPower = std::size_t{1} << kStepBits;
  const std::size_t above = step < kPerPower ? 0 : (step >> kStepBits) - 1;
  const std::uint64_t least = std::uint64_t{step - (above << kStepBits)} << above;
  const std::uint64_t width = std::uint64_t{1} << above;
  return Duration(((2 * least + width) << kUnitBits) / 2);
}

void LogHistogram::add(Duration duration) noexcept {
  constexpr std::int64_t kMost = (std::int64_t{1} << kValueBits) - 1;
  const std::int64_t units = std::clamp<std::int64_t>(duration.count() >> kUnitBits, 0, kMost);
  ++counts_[step_of(static_cast<std::uint32_t>(units))];
  if (++total_ < kForgetAt) {
    return;
  }
  total_ = 0;
  for (std::uint16_t& count : counts_) {
    count /= 2;
    total_ += count;
  }
}

LogHistogram::Percentiles LogHistogram::percentiles() const noexcept {
  constexpr std::uint32_t kPercent = 100;
  if (total_ == 0) {
    return {};
  }
  const auto rank = [this](std::uint32_t percent) { return (total_ * percent + kPercent - 1) / kPercent; };
  return {.count = total_, .p50 = at_rank(rank(50)), .p99 = at_rank(rank(99))};
}

Duration LogHistogram::at_rank(std::uint32_t rank) const noexcept {
  std::uint32_t passed = 0;
  std::size_t step = 0;
  for (; step + 1 < counts_.size(); ++step) {
    passed += counts_[step];
    if (passed >= rank) {
      break;
    }
  }
  return middle_of(step);
}

}  // namespace canopen
