#pragma once

#include <algorithm>
#include <string>
#include <string_view>
#include <utility>

#include "canopen/clock.h"
#include "canopen/node/boot_result.h"

namespace canopen {

/// How long a node is left alone after a boot or takeover that ended with a letter: 5 s, and for the same cause twice
/// as long each time, up to a minute. So many drives with one mistake in their configuration take little of the bus. A
/// plain value.
class RetryPause {
 public:
  static constexpr Duration kFirst = std::chrono::seconds(5);
  static constexpr Duration kLongest = std::chrono::minutes(1);

  /// It rebooted, or somebody asked us to start it: the next pause is the first.
  void begin_anew() noexcept { *this = RetryPause(); }
  /// It ended so. `cause`: what of the reason does not change by itself from one try to the next.
  [[nodiscard]] Duration after(BootResult letter, std::string_view cause) {
    if (letter != letter_ || cause != cause_) {
      letter_ = letter;
      cause_ = cause;
      pause_ = kFirst;
    }
    return std::exchange(pause_, std::min(2 * pause_, kLongest));
  }

 private:
  BootResult letter_ = BootResult::not_booted;
  std::string cause_;
  Duration pause_ = kFirst;
};

}  // namespace canopen
