#pragma once

#include <algorithm>

#include "canopen/clock.h"

namespace canopen {

/// When a node that left operational by itself is to be tried again: after 5 s, the next times after twice as long, up
/// to a minute; anew from 5 s where it stayed operational for a minute. A plain value.
class Restart {
 public:
  static constexpr Duration kFirstPause = std::chrono::seconds(5);
  static constexpr Duration kLongestPause = std::chrono::minutes(1);

  explicit Restart(bool wanted) noexcept : wanted_(wanted) {}

  /// It rebooted, or somebody asked us to start it.
  void begin_anew() noexcept { pause_ = kFirstPause; }
  void come_online(TimePoint now) noexcept {
    online_since_ = now;
    at_ = kNever;
    foreign_ = false;
  }
  /// Another master sent an NMT command to it or to all: where it is now may be his will.
  void hear_foreign_nmt() noexcept {
    foreign_ = true;
    at_ = kNever;
  }
  void leave(TimePoint now) noexcept {
    if (now - online_since_ >= kLongestPause) {
      pause_ = kFirstPause;
    }
    put_off(now);
  }
  /// It was not to be started now.
  void put_off(TimePoint now) noexcept {
    at_ = wanted_ && !foreign_ ? now + pause_ : kNever;
    pause_ = std::min(2 * pause_, kLongestPause);
  }
  void end() noexcept { at_ = kNever; }
  /// As it was before end(), but for what was heard since.
  void resume(const Restart& before) noexcept { at_ = foreign_ ? kNever : before.at_; }

  /// kNever: not by us.
  [[nodiscard]] TimePoint at() const noexcept { return at_; }
  [[nodiscard]] bool foreign_nmt() const noexcept { return foreign_; }

 private:
  bool wanted_;
  bool foreign_ = false;
  TimePoint online_since_{};
  TimePoint at_ = kNever;
  Duration pause_ = kFirstPause;
};

}  // namespace canopen
