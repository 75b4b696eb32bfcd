#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "canopen/clock.h"

namespace canopen {

/// How often durations came, in steps that grow with them: a 16th of the power of two below. So a percentile is off
/// by at most 1/32 of itself, or 0.6 us where that is more. What is longer than 137 s counts as 137 s. A plain value of
/// constant size.
class LogHistogram {
 public:
  /// With so many all counts are halved: what is told is of the newest, and what was before counts less and less.
  static constexpr std::uint32_t kForgetAt = 4096;

  struct Percentiles {
    std::uint32_t count = 0;  ///< That they are of, at most kForgetAt; 0: the others mean nothing.
    Duration p50{};
    Duration p99{};
    friend bool operator==(const Percentiles&, const Percentiles&) = default;
  };

  /// Negative ones count as zero.
  void add(Duration duration) noexcept;
  [[nodiscard]] Percentiles percentiles() const noexcept;

 private:
  static constexpr unsigned kStepBits = 4;  ///< Steps for each power of two, as a power of two.
  static constexpr unsigned kValueBits = 27;
  static constexpr std::size_t kSteps = std::size_t{kValueBits - kStepBits + 1} << kStepBits;

  [[nodiscard]] static std::size_t step_of(std::uint32_t units) noexcept;
  [[nodiscard]] static Duration middle_of(std::size_t step) noexcept;
  [[nodiscard]] Duration at_rank(std::uint32_t rank) const noexcept;

  std::array<std::uint16_t, kSteps> counts_{};
  std::uint32_t total_ = 0;
};

}  // namespace canopen
