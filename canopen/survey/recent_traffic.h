#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "canopen/survey/error_counts.h"

namespace canopen {

/// Errors and frames of the last minute, second by second. A plain value.
class RecentTraffic {
 public:
  static constexpr std::size_t kSeconds = 60;

  struct Sum {
    ErrorCounts errors{};
    std::uint32_t received = 0;  ///< Frames of others.
  };

  void add_error(const ErrorCounts& counts) noexcept { seconds_[current_].errors += counts; }
  void add_received() noexcept { ++seconds_[current_].received; }
  /// So many seconds are over.
  void pass(std::size_t seconds) noexcept;
  /// Of the last `seconds`, at most kSeconds, and of the current one.
  [[nodiscard]] Sum of_last(std::size_t seconds) const noexcept;

 private:
  std::array<Sum, kSeconds + 1> seconds_{};
  std::size_t current_ = 0;
};

}  // namespace canopen
