#pragma once

#include <chrono>
#include <cstddef>
#include <deque>
#include <map>
#include <string>

#include "canopen/clock.h"

namespace recorder {

/// How many records one subject, a drive or a bus, may have in an hour.
class Quota {
 public:
  static constexpr std::size_t kMost = 10;
  static constexpr canopen::Duration kTime = std::chrono::hours(1);

  struct Verdict {
    bool allowed = true;
    bool first_refusal = false;      ///< The first since the last record.
    std::size_t refused_before = 0;  ///< With `allowed`: so many were refused since the last one.
  };
  /// One is to begin; it counts where it is allowed.
  [[nodiscard]] Verdict take(const std::string& subject, canopen::TimePoint now);

 private:
  struct Subject {
    std::deque<canopen::TimePoint> begun;
    std::size_t refused = 0;
  };
  std::map<std::string, Subject> subjects_;  ///< No more than there are drives and buses, and twice that.
};

}  // namespace recorder
