#pragma once

#include <algorithm>
#include <utility>

#include "canopen/clock.h"

namespace canopen {

/// Until when the SDO server of a node may be silent, since it wakes up later than the rest of it
/// (SdoSettings::patience), and how far apart the boots are that are tried until then. Counts from the node's boot-up
/// message. Of a node that was away, or was reset, that message may have been missed: there from its first sign of
/// another state than operational. Further boot-ups do not prolong it before a boot of the node has come to an end with
/// answers (settle()): one that reboots for ever has its letter, too. A plain value.
class SdoPatience {
 public:
  static constexpr Duration kFirstPause = std::chrono::milliseconds(500);
  static constexpr Duration kLongestPause = std::chrono::seconds(2);

  explicit SdoPatience(Duration patience) noexcept : patience_(patience) {}

  /// Its boot-up message was received at `at`.
  void begin(TimePoint at) noexcept {
    pause_ = kFirstPause;
    if (std::exchange(away_, false) || settled_) {
      until_ = at + patience_;
      settled_ = false;
      told_ = false;
    }
  }
  /// It is in service, or it answered and has a letter for something else.
  void settle() noexcept { settled_ = true; }
  /// It was lost, nobody can hear it, or it was told to reset.
  void expect_boot_up() noexcept { away_ = true; }
  /// It shows its state.
  void hear(bool operational, TimePoint at) noexcept {
    if (!away_) {
      return;
    }
    if (operational) {
      away_ = false;
      settle();
    } else {
      begin(at);
    }
  }

  [[nodiscard]] bool lasts(TimePoint now) const noexcept { return now < until_; }
  [[nodiscard]] TimePoint until() const noexcept { return until_; }
  /// True once since it began.
  [[nodiscard]] bool to_be_told() noexcept { return !std::exchange(told_, true); }
  /// When it is asked again; at the end of the patience for the last time without a letter.
  [[nodiscard]] TimePoint next_try(TimePoint now) noexcept {
    const TimePoint next = now + pause_;
    pause_ = std::min(2 * pause_, kLongestPause);
    return std::min(next, until_);
  }

 private:
  Duration patience_;
  TimePoint until_{};
  Duration pause_ = kFirstPause;
  bool away_ = true;      ///< Before it was ever heard, too.
  bool settled_ = false;  ///< Its next boot-up has a patience of its own.
  bool told_ = false;
};

}  // namespace canopen
